"""The line-contact challenge: problems in plain numbers with certified answers, a judge, and recorded standings."""

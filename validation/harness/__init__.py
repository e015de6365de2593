"""What cases, studies and pages share: figures as data, problems in raw numbers, provenance."""

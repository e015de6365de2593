"""Common ground of cases, studies and pages: figures as data, problems in raw numbers, provenance."""

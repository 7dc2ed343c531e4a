"""The learned estimators, one file each."""

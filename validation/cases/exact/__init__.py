"""Cases with an exact answer: sinusoids, single patches, complete contact, the last gaps before it."""

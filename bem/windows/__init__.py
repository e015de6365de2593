"""Contacts of many patches: the path of each window of patches in the far field of the others, joined."""

"""Cases of Persson's theory with adhesion: its accuracy, and what it says of a contact."""

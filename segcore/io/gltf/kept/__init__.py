"""Writers of files that keep everything of their input: its glTF with every primitive divided by part."""

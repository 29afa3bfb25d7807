"""The objects that a store is made of: files in a folder or objects in a bucket."""

"""Affinity: the weights of a graph of faces or vertices, and the measurements that they are made of."""

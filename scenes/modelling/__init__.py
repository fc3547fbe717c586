"""Modelling kit of the example scenes: meshes, procedural textures, GLB and HDR files.

Needs numpy and Pillow only. Everything is deterministic: random numbers come
from seeded generators, and files hold neither dates nor machine names.
Lengths are metres, +Y is up, front faces wind counter-clockwise, and (0, 0)
in texture space is the top left corner, as in glTF 2.0.
"""

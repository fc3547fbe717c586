"""The seven gates, one file each, in the order in which they are asked.

1. `structure`: windows, channels, types, metadata.
2. `finite`: no NaN, infinity or negative light.
3. `exact`: equal pixels end the comparison with a pass.
4. `statistical`: block means differ by no more than their noise.
5. `variance`: the noise itself is what it was.
6. `flip`: what a person would see.
7. `numbers`: layers, and the classic error measures.

A gate is a function of two pictures and the settings. It does not know the others, but for `flip`, which is told why
`statistical` did not judge.
"""

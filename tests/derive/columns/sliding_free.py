"""A sliding-free column under follower forces at its end and along it: one rigid function, words that break strings."""

from freebeam_derive.notation import F_0, P, alpha, beta, t, x, x_F, y
from freebeam_derive.statement import Column, at, delta, integral

column = Column(
    name="sliding-free",
    title='Sliding-free column, M\\"uller\'s """upper""" half',
    T=integral(y.diff(t) ** 2) / 2,
    V=integral(y.diff(x, 2) ** 2) / 2,
    W_c=P * integral((1 + x**2) * y.diff(x) ** 2) / 4,
    dW_nc=-integral(beta * y.diff(t) * delta(y) + alpha * y.diff(x, 2, t) * delta(y.diff(x, 2)))
    - P * at(y.diff(x), 1) * at(delta(y), 1)
    - P * integral(x * y.diff(x) * delta(y))
    + F_0 * at(delta(y), x_F),
    ends=("sliding", "free"),
    source=r"by the authors of \x and \N",
)

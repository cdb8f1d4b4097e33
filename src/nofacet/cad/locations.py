"""Locations: products of powers of elementary placements ("datums"), each distinct one known by a number."""

from __future__ import annotations

from functools import reduce

import numpy as np
from numpy.typing import NDArray

Location = tuple[tuple[int, int], ...]  # (datum, power) pairs, rightmost factor first, as TopLoc_Location has them


def multiply(left: Location, right: Location) -> Location:
    """The location left * right with equal neighbours merged, as TopLoc_Location::Multiplied does."""
    result = left
    for datum, power in reversed(right):
        if result and result[0][0] == datum:
            power += result[0][1]
            result = result[1:]
        if power:
            result = ((datum, power), *result)
    return result


class Locations:
    """Numbered locations; 0 is the identity, equal ones have equal numbers, products are added when asked for."""

    def __init__(self, chains: list[Location], datums: NDArray[np.float64]) -> None:
        """chains: of the locations 0, 1, ..; datums: matrices (n, 4, 4) of the datums in the order of their numbers,
        a datum being a location whose chain is its own number to the power of one."""
        self._chains = chains
        self._number: dict[Location, int] = {}
        for number, chain in enumerate(chains):
            self._number.setdefault(chain, number)
        self._products: dict[tuple[int, int], int] = {}
        elementary = (number for number, chain in enumerate(chains) if chain == ((number, 1),))
        self._matrices = dict(zip(elementary, datums, strict=True))

    def compose(self, left: int, right: int) -> int:
        """The number of location left * right."""
        if not left or not right:
            return left or right
        product = self._products.get((left, right))
        if product is None:
            chain = multiply(self._chains[left], self._chains[right])
            product = self._products[left, right] = self._number.setdefault(chain, len(self._chains))
            if product == len(self._chains):
                self._chains.append(chain)
        return product

    def compose_all(self, left: NDArray[np.intp], right: NDArray[np.intp]) -> NDArray[np.intp]:
        """compose() of each pair (n,), (n,)."""
        result = np.maximum(left, right)
        both = np.flatnonzero((left > 0) & (right > 0))
        if len(both):
            pairs = zip(left[both].tolist(), right[both].tolist(), strict=True)
            result[both] = [self.compose(*pair) for pair in pairs]
        return result

    def matrix(self, number: int) -> NDArray[np.float64]:
        """The (4, 4) matrix of a location."""
        if number not in self._matrices:
            powers = [self._power(datum, power) for datum, power in self._chains[number]]
            self._matrices[number] = reduce(lambda product, factor: factor @ product, powers, np.eye(4))
        return self._matrices[number]

    def _power(self, datum: int, power: int) -> NDArray[np.float64]:
        matrix = self.matrix(datum)
        return matrix if power == 1 else np.linalg.matrix_power(matrix, power)

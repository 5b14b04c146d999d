"""The U test of Mann and Whitney (1947), two-sided: do two samples differ in place?

What google/benchmark's compare.py asks of scipy, without the need for it. Times are skewed and have
outliers, so ranks say more than means.
"""

import math


def ranks(values):
    """1 for the smallest; ties share the mean of their ranks."""
    order = sorted(range(len(values)), key=values.__getitem__)
    found = [0.0] * len(values)
    first = 0
    while first < len(order):
        last = first
        while last + 1 < len(order) and values[order[last + 1]] == values[order[first]]:
            last += 1
        for place in order[first : last + 1]:
            found[place] = 0.5 * (first + last) + 1.0
        first = last + 1
    return found


def arrangements(n, m):
    """counts[u]: in how many of the (n + m choose n) orders of two samples U is u, no ties."""
    # Mann and Whitney's recurrence: the largest value is of the first sample, which then beats all m
    # of the second, or of the second.
    rows = [[1] for _ in range(m + 1)]
    for i in range(1, n + 1):
        previous, rows = rows, [[1]]
        for j in range(1, m + 1):
            counts = [0] * (i * j + 1)
            for u, ways in enumerate(previous[j]):
                counts[u + j] += ways
            for u, ways in enumerate(rows[j - 1]):
                counts[u] += ways
            rows.append(counts)
    return rows[m]


def u_test(a, b):
    """Probability of a difference in ranks as large as this one, or larger, by chance alone.

    Exact without ties up to 20 values each; else the normal approximation with corrections for ties
    and for continuity. 1 if all values are equal. ValueError if a sample is empty.
    """
    n, m = len(a), len(b)
    if not n or not m:
        raise ValueError("a sample is empty")
    values = list(a) + list(b)
    u = sum(ranks(values)[:n]) - n * (n + 1) / 2
    smaller = min(u, n * m - u)
    if len(set(values)) == len(values) and max(n, m) <= 20:
        counts = arrangements(n, m)
        return min(1.0, 2.0 * sum(counts[: int(smaller) + 1]) / math.comb(n + m, n))
    total = n + m
    ties = sum(count**3 - count for count in map(values.count, set(values)))
    variance = n * m / 12 * (total + 1 - ties / (total * (total - 1)))
    if variance <= 0.0:
        return 1.0
    z = max(0.0, n * m / 2 - smaller - 0.5) / math.sqrt(variance)
    return math.erfc(z / math.sqrt(2.0))

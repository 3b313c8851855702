"""Arrays of whole numbers as text that a browser unpacks (web/codec.js).

Rows (the first axis) are replaced by differences from the row before, or by differences of these,
whichever are smaller; the sign becomes the last bit; bytes of the same weight stand together; zlib;
base64.
"""
import base64
import zlib

import numpy as np


def cost(differences):
    """About how many bits the numbers take."""
    return np.log2(1 + np.abs(differences)).sum()


def residuals(values):
    """Rows or their differences, and per row of which order: 0, 1 or 2."""
    found, orders = np.empty_like(values), []
    for k, row in enumerate(values):
        tried = [row]
        if k > 0:
            tried.append(row - values[k - 1])
        if k > 1:
            tried.append(row - 2 * values[k - 1] + values[k - 2])
        best = int(np.argmin([cost(one) for one in tried]))
        found[k] = tried[best]
        orders.append(best)
    return found, orders


def pack(values):
    """{"shape", "orders", "data"} of whole numbers of less than 2^28 in size."""
    values = np.asarray(values, np.int64)
    if np.abs(values).max(initial=0) >= 1 << 28:
        raise ValueError("numbers of 2^28 and more cannot be packed")
    rows, orders = residuals(values)
    signed = (rows << 1 ^ rows >> 63).ravel()
    planes = max(1, (int(signed.max(initial=0)).bit_length() + 7) // 8)
    data = b"".join((signed >> 8 * p & 255).astype(np.uint8).tobytes() for p in range(planes))
    return {"shape": list(values.shape), "orders": orders,
            "data": base64.b64encode(zlib.compress(data, 6)).decode()}


def unpack(packed):
    """The numbers again."""
    count = int(np.prod(packed["shape"]))
    data = np.frombuffer(zlib.decompress(base64.b64decode(packed["data"])), np.uint8)
    planes = data.reshape(-1, count) if count else np.zeros((0, 0))
    signed = sum((plane.astype(np.int64) << 8 * p for p, plane in enumerate(planes)),
                 np.zeros(count, np.int64))
    rows = (signed >> 1 ^ -(signed & 1)).reshape(packed["shape"])
    for k, order in enumerate(packed["orders"]):
        if order == 1:
            rows[k] += rows[k - 1]
        elif order == 2:
            rows[k] += 2 * rows[k - 1] - rows[k - 2]
    return rows

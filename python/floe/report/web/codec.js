// Arrays of a report: base64 of zlib streams, as python/floe/report/arrays.py packs them.
'use strict';

const floeArrays = (() => {
  function bytesOf(text) {
    if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
    const raw = atob(text), bytes = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; ++k) bytes[k] = raw.charCodeAt(k);
    return bytes;
  }

  async function inflated(bytes) {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }

  // Planes of bytes, the lowest first, of numbers whose sign is their last bit.
  function numbersOf(bytes, count) {
    const values = new Int32Array(count), planes = count ? bytes.length / count : 0;
    for (let p = 0; p < planes; ++p) {
      const from = p * count, shift = 8 * p;
      for (let k = 0; k < count; ++k) values[k] |= bytes[from + k] << shift;
    }
    for (let k = 0; k < count; ++k) values[k] = (values[k] >>> 1) ^ -(values[k] & 1);
    return values;
  }

  // Rows hold themselves, differences from the row before, or differences of these.
  function summed(values, orders) {
    const width = orders.length ? values.length / orders.length : 0;
    for (let row = 0; row < orders.length; ++row) {
      const at = row * width, order = orders[row];
      for (let k = at; k < at + width; ++k) {
        if (order === 1) values[k] += values[k - width];
        else if (order === 2) values[k] += 2 * values[k - width] - values[k - 2 * width];
      }
    }
    return values;
  }

  async function unpack(packed) {
    const count = packed.shape.reduce((product, n) => product * n, 1);
    const values = numbersOf(await inflated(bytesOf(packed.data)), count);
    return summed(values, packed.orders);
  }

  return {unpack};
})();

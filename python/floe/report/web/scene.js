// The scene of a report in three dimensions. Poses go to the graphics card as a texture, three
// texels per body: place and scale, quaternion, colour; bodies, edges, cracks, obstacles, water and
// arrows are one draw call each.
'use strict';

const floeScene = (() => {
  const across = 3072;  // texels in a row of a texture of poses, a multiple of 3
  const selectedColour = [1.0, 0.55, 0.1];

  const vertexShader = `
    precision highp float;
    uniform highp sampler2D poses;
    uniform float heights, selected, now;
    attribute float body;
    attribute float since;
    varying vec3 at;
    varying vec4 colour;
    vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
    vec4 texel(int k) { return texelFetch(poses, ivec2(k % ${across}, k / ${across}), 0); }
    void main() {
      int first = 3 * int(body + 0.5);
      vec4 place = texel(first), turn = texel(first + 1);
      colour = texel(first + 2);
      if (body == selected) colour = vec4(${selectedColour.join(',')}, 2.0);
      vec3 world = turned(turn, position * place.w) + place.xyz;
      at = world;
      vec4 seen = viewMatrix * vec4(world, 1.0);
      gl_Position = projectionMatrix * seen;
      // not yet, or of a body that does not exist
      if (since > now || place.w == 0.0) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    }`;

  // The light comes from above, from behind the eye and from the side.
  const litShader = `
    precision highp float;
    uniform float level, byHeight, opacity;
    varying vec3 at;
    varying vec4 colour;
    vec3 ice(float z) {
      vec3 c = mix(vec3(0.05, 0.16, 0.30), vec3(0.20, 0.45, 0.62), smoothstep(-3.0, -0.5, z));
      c = mix(c, vec3(0.62, 0.78, 0.88), smoothstep(-0.5, -0.05, z));
      c = mix(c, vec3(0.86, 0.92, 0.96), smoothstep(-0.05, 0.05, z));
      c = mix(c, vec3(0.97, 0.98, 1.00), smoothstep(0.05, 0.6, z));
      return mix(c, vec3(1.0, 0.95, 0.84), smoothstep(0.6, 3.0, z));
    }
    void main() {
      vec3 normal = normalize(cross(dFdx(at), dFdy(at)));
      vec3 eye = normalize(cameraPosition - at);
      if (dot(normal, eye) < 0.0) normal = -normal;
      float light = 0.42 + 0.30 * max(0.0, dot(normal, eye)) + 0.16 * max(0.0, normal.z)
        + 0.24 * max(0.0, dot(normal, normalize(vec3(0.5, -0.3, 0.8))));
      vec3 base = byHeight > 0.5 && colour.a < 1.5 ? ice(at.z - level) : colour.rgb;
      gl_FragColor = vec4(base * light, opacity);
    }`;

  const plainShader = `
    precision highp float;
    uniform vec3 paint;
    uniform float opacity;
    varying vec4 colour;
    void main() { gl_FragColor = vec4(paint, opacity); }`;

  // -- what the file holds --------------------------------------------------------------------
  async function unpackScene(packed) {
    const scene = {...packed};
    for (const key of ['corners', 'counts', 'sides', 'faces', 'poses', 'beams', 'places']) {
      scene[key] = await floeArrays.unpack(packed[key]);
    }
    scene.ids = packed.ids ? await floeArrays.unpack(packed.ids) : null;
    scene.life = packed.life ? await floeArrays.unpack(packed.life) : null;
    scene.crackCorners = await floeArrays.unpack(packed.cracks.corners);
    scene.crackOf = await floeArrays.unpack(packed.cracks.of);
    return scene;
  }

  // Merged corners, triangles, edges and the planes of faces of all bodies.
  function meshOf(scene) {
    const n = scene.bodies, points = scene.corners.length / 3;
    const position = new Float32Array(3 * points), body = new Float32Array(points);
    for (let k = 0; k < points; ++k) {
      for (let i = 0; i < 3; ++i) position[3 * k + i] = scene.corners[i * points + k] * scene.step;
    }
    const triangles = [], edges = [], planes = [], planeOf = [0], radius = new Float32Array(n);
    let corner = 0, face = 0, side = 0;
    for (let b = 0; b < n; ++b) {
      for (let k = 0; k < scene.counts[b]; ++k) {
        const at = 3 * (corner + k), [x, y, z] = [position[at], position[at + 1], position[at + 2]];
        body[corner + k] = b;
        radius[b] = Math.max(radius[b], Math.hypot(x, y, z));
      }
      for (let f = 0; f < scene.counts[n + b]; ++f, ++face) {
        const sides = scene.sides[face], ring = [];
        for (let k = 0; k < sides; ++k) ring.push(corner + scene.faces[side++]);
        for (let k = 1; k < sides - 1; ++k) triangles.push(ring[0], ring[k], ring[k + 1]);
        for (let k = 0; k < sides; ++k) {
          const a = ring[k], z = ring[(k + 1) % sides];
          if (a < z) edges.push(a, z);  // the other face has it the other way round
        }
        planes.push(...planeThrough(position, ring));
      }
      corner += scene.counts[b];
      planeOf.push(planes.length / 4);
    }
    return {position, body, triangles: new Uint32Array(triangles), edges: new Uint32Array(edges),
            planes: new Float32Array(planes), planeOf, radius};
  }

  function planeThrough(position, ring) {  // n x <= d inside
    const p = k => [0, 1, 2].map(i => position[3 * k + i]);
    const n = [0, 0, 0], a = p(ring[0]);
    for (let k = 1; k < ring.length - 1; ++k) {
      const b = p(ring[k]), c = p(ring[k + 1]);
      const u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
      n[0] += u[1] * w[2] - u[2] * w[1];
      n[1] += u[2] * w[0] - u[0] * w[2];
      n[2] += u[0] * w[1] - u[1] * w[0];
    }
    const size = Math.hypot(...n) || 1;
    return [...n.map(v => v / size), (n[0] * a[0] + n[1] * a[1] + n[2] * a[2]) / size];
  }

  // First and last frame of a body: all, or those between which it exists.
  function lifeOf(scene, b) {
    return scene.life ? [scene.life[b], scene.life[scene.bodies + b]] :
      [0, scene.times.length - 1];
  }

  // Whether a body exists at a frame, which may lie between two.
  function exists(scene, frame, b) {
    return !scene.life || scene.life[b] <= frame && frame <= scene.life[scene.bodies + b];
  }

  // -- poses ----------------------------------------------------------------------------------
  // Quaternion (x, y, z, w) of a rotation vector.
  function quaternionOf(x, y, z) {
    const angle = Math.hypot(x, y, z);
    const s = angle < 1e-9 ? 0.5 : Math.sin(angle / 2) / angle;
    return [x * s, y * s, z * s, Math.cos(angle / 2)];
  }

  function quaternionOfMatrix(m) {
    const q = new THREE.Quaternion().setFromRotationMatrix(new THREE.Matrix4().set(
      ...m[0], 0, ...m[1], 0, ...m[2], 0, 0, 0, 0, 1));
    return [q.x, q.y, q.z, q.w];
  }

  function bodyPose(scene, frame, b) {
    const n = scene.bodies, at = 6 * n * frame + b, p = scene.poses, s = scene.turn_step;
    return {place: [0, 1, 2].map(i => (p[at + i * n] + scene.places[i * n + b]) * scene.step),
            turn: quaternionOf(p[at + 3 * n] * s, p[at + 4 * n] * s, p[at + 5 * n] * s)};
  }

  function between(a, b, f) {
    const near = a.turn.reduce((sum, v, i) => sum + v * b.turn[i], 0) < 0 ? -1 : 1;
    const turn = a.turn.map((v, i) => v + f * (near * b.turn[i] - v));
    const size = Math.hypot(...turn);
    return {place: a.place.map((v, i) => v + f * (b.place[i] - v)), turn: turn.map(v => v / size)};
  }

  function textureFor(count) {
    const rows = Math.max(1, Math.ceil(3 * count / across));
    const data = new Float32Array(4 * across * rows);
    const texture = new THREE.DataTexture(data, across, rows, THREE.RGBAFormat, THREE.FloatType);
    texture.needsUpdate = true;
    return {data, texture};
  }

  function put(data, k, pose, scale, colour) {
    const at = 12 * k;
    data[at] = pose.place[0]; data[at + 1] = pose.place[1]; data[at + 2] = pose.place[2];
    data[at + 3] = scale;
    for (let i = 0; i < 4; ++i) data[at + 4 + i] = pose.turn[i];
    for (let i = 0; i < 3; ++i) data[at + 8 + i] = colour[i];
    data[at + 11] = 1;
  }

  // All bodies between frames k and k + 1, written without making anything.
  function fillBodies(scene, data, frame, f) {
    const n = scene.bodies, p = scene.poses, s = scene.turn_step / 2;
    const a = 6 * n * frame, b = f > 0 ? a + 6 * n : a;
    for (let k = 0; k < n; ++k) {
      const at = 12 * k;
      for (let i = 0; i < 3; ++i) {
        const here = p[a + i * n + k];
        data[at + i] = (scene.places[i * n + k] + here + f * (p[b + i * n + k] - here)) *
          scene.step;
      }
      data[at + 3] = exists(scene, frame + f, k) ? 1 : 0;
      turnInto(data, at + 4, p, a + 3 * n + k, b + 3 * n + k, n, s, f);
    }
  }

  function turnInto(data, to, p, a, b, n, s, f) {
    const ax = p[a] * s, ay = p[a + n] * s, az = p[a + 2 * n] * s;
    const bx = p[b] * s, by = p[b + n] * s, bz = p[b + 2 * n] * s;
    const la = Math.sqrt(ax * ax + ay * ay + az * az);
    const lb = Math.sqrt(bx * bx + by * by + bz * bz);
    const sa = la < 1e-9 ? 1 : Math.sin(la) / la, ca = Math.cos(la);
    let sb = lb < 1e-9 ? 1 : Math.sin(lb) / lb, cb = Math.cos(lb);
    if (sa * sb * (ax * bx + ay * by + az * bz) + ca * cb < 0) { sb = -sb; cb = -cb; }
    const x = ax * sa + f * (bx * sb - ax * sa), y = ay * sa + f * (by * sb - ay * sa);
    const z = az * sa + f * (bz * sb - az * sa), w = ca + f * (cb - ca);
    const size = 1 / Math.sqrt(x * x + y * y + z * z + w * w);
    data[to] = x * size; data[to + 1] = y * size; data[to + 2] = z * size; data[to + 3] = w * size;
  }

  // -- fragments ------------------------------------------------------------------------------
  // Pieces joined by beams that are whole at a frame: per body its piece (-1: the body does not
  // exist), and each piece's bodies and mass, the heaviest first.
  function fragmentsAt(scene, frame) {
    const time = scene.times[frame], there = b => exists(scene, frame, b);
    const n = scene.bodies, m = scene.beams.length / 3, parent = new Int32Array(n).map((_, k) => k);
    const root = k => { while (parent[k] !== k) k = parent[k] = parent[parent[k]]; return k; };
    for (let k = 0; k < m; ++k) {
      const ended = scene.beams[2 * m + k];
      if ((ended < 0 || ended > 1000 * time) && there(scene.beams[k]) &&
          there(scene.beams[m + k])) {
        const a = root(scene.beams[k]), b = root(scene.beams[m + k]);
        if (a !== b) parent[Math.max(a, b)] = Math.min(a, b);
      }
    }
    const found = new Map();
    for (let k = 0; k < n; ++k) {
      if (!there(k)) continue;
      const r = root(k), one = found.get(r) || {root: r, bodies: 0, mass: 0};
      one.bodies += 1;
      one.mass += scene.masses[k];
      found.set(r, one);
    }
    const pieces = [...found.values()].sort((a, b) => b.mass - a.mass || a.root - b.root);
    const number = new Map(pieces.map((one, k) => [one.root, k]));
    const of = Int32Array.from(parent, (_, k) => (there(k) ? number.get(root(k)) : -1));
    return {of, pieces};
  }

  function hue(k, light) {
    const h = (k * 0.61803398875) % 1 * 6, x = 1 - Math.abs(h % 2 - 1), c = 0.42;
    const rgb = [[c, x * c, 0], [x * c, c, 0], [0, c, x * c], [0, x * c, c], [x * c, 0, c],
                 [c, 0, x * c]][Math.floor(h)];
    return rgb.map(v => v + light - c / 2);
  }

  function speedColour(share) {
    const stops = [[0.90, 0.94, 0.97], [0.50, 0.75, 0.88], [0.98, 0.80, 0.36], [0.84, 0.24, 0.12]];
    const at = Math.min(2.999, Math.max(0, share) * 3), k = Math.floor(at), f = at - k;
    return stops[k].map((c, i) => c + f * (stops[k + 1][i] - c));
  }

  return {unpackScene, meshOf, planeThrough, lifeOf, exists, bodyPose, between, quaternionOfMatrix,
          textureFor, put, fillBodies, fragmentsAt, hue, speedColour, vertexShader, litShader,
          plainShader};
})();

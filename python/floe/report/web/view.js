// The window into the scene: camera, play, pick. Nothing is drawn while nothing changes.
'use strict';

class FloeView {
  constructor(parent, scene) {
    this.scene = scene;
    this.parent = parent;
    this.frame = 0;       // with a fraction between two frames
    this.playing = false;
    this.colour = 'height';
    this.selected = -1;
    this.fragments = null;
    this.listeners = [];
    this.rate = 0;        // frames drawn a second, measured while it moves
    this.mesh = floeScene.meshOf(scene);
    this.duration = scene.times.at(-1) - scene.times[0];
    this.speed = this.duration > 0 ? this.niceSpeed() : 1;
    this.makeRenderer();
    this.makeObjects();
    this.resize();
    this.placeCamera();
    this.setFrame(0);
    new ResizeObserver(() => this.resize()).observe(parent);
  }

  niceSpeed() {  // the whole in about 15 s
    const wanted = this.duration / 15, size = 10 ** Math.floor(Math.log10(wanted));
    return size * [1, 2, 5, 10].reduce((a, b) => (
      Math.abs(b * size - wanted) < Math.abs(a * size - wanted) ? b : a));
  }

  // -- set-up ---------------------------------------------------------------------------------
  makeRenderer() {
    this.renderer = new THREE.WebGLRenderer({antialias: true, powerPreference: 'default'});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setClearColor(0xf4f7fa, 1);
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute('aria-label', 'the scene in three dimensions');
    this.parent.append(this.canvas);
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.1, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener('change', () => this.request());
    this.world = new THREE.Scene();
    // The wheel scrolls the page until the scene has been touched.
    this.controls.enableZoom = false;
    document.addEventListener('pointerdown', event => {
      this.controls.enableZoom = event.target === this.canvas;
    }, true);
    this.canvas.addEventListener('pointerdown', event => {
      this.pressed = [event.clientX, event.clientY];
    });
    this.canvas.addEventListener('pointerup', event => this.released(event));
  }

  material(shader, texture, options = {}) {
    const {uniforms = {}, ...rest} = options;
    return new THREE.ShaderMaterial({
      vertexShader: floeScene.vertexShader, fragmentShader: shader, side: THREE.DoubleSide,
      uniforms: {poses: {value: texture}, level: {value: -this.scene.origin[2]},
                 byHeight: {value: 0}, opacity: {value: 1}, selected: {value: -5},
                 now: {value: 0}, paint: {value: new THREE.Color(0, 0, 0)}, ...uniforms}, ...rest});
  }

  geometry(position, body, index, since = null) {
    const made = new THREE.BufferGeometry();
    made.setAttribute('position', new THREE.BufferAttribute(position, 3));
    made.setAttribute('body', new THREE.BufferAttribute(body, 1));
    made.setAttribute('since', new THREE.BufferAttribute(
      since || new Float32Array(body.length).fill(-1), 1));
    if (index) made.setIndex(new THREE.BufferAttribute(index, 1));
    return made;
  }

  add(object, order = 0) {
    object.frustumCulled = false;  // its poses are on the card
    object.renderOrder = order;
    this.world.add(object);
    return object;
  }

  makeObjects() {
    const {mesh, scene} = this;
    this.poses = floeScene.textureFor(scene.bodies);
    const solid = this.geometry(mesh.position, mesh.body, mesh.triangles);
    this.bodies = this.add(new THREE.Mesh(solid, this.material(
      floeScene.litShader, this.poses.texture,
      {polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
       uniforms: {byHeight: {value: 1}}})));
    const lines = this.geometry(mesh.position, mesh.body, mesh.edges);
    this.edges = this.add(new THREE.LineSegments(lines, this.material(
      floeScene.plainShader, this.poses.texture, {transparent: true, uniforms: {
        paint: {value: new THREE.Color(0.13, 0.22, 0.3)}, opacity: {value: 0.34}}})), 1);
    this.makeCracks();
    this.makeObstacles();
    this.makeArrows();
    if (scene.water) this.makeWater();
  }

  makeCracks() {  // faces of broken sections, with their bodies
    const {scene} = this, count = scene.crackOf.length / 2;
    if (!count) return;
    const position = Float32Array.from(scene.crackCorners, v => v * scene.step);
    const body = new Float32Array(4 * count), since = new Float32Array(4 * count), index = [];
    for (let k = 0; k < count; ++k) {
      body.fill(scene.crackOf[k], 4 * k, 4 * k + 4);
      since.fill(scene.crackOf[count + k] / 1000, 4 * k, 4 * k + 4);
      const a = 4 * k;
      index.push(a, a + 1, a + 1, a + 2, a + 2, a + 3, a + 3, a);
    }
    this.cracks = this.add(new THREE.LineSegments(
      this.geometry(position, body, new Uint32Array(index), since),
      this.material(floeScene.plainShader, this.poses.texture, {uniforms: {
        paint: {value: new THREE.Color(0.78, 0.13, 0.10)}}})), 2);
  }

  makeObstacles() {
    const {obstacles} = this.scene;
    if (!obstacles.length) return;
    this.places = floeScene.textureFor(obstacles.length);
    const make = (plane, options, order) => {
      const position = [], body = [], index = [];
      obstacles.forEach((one, k) => {
        if (one.plane !== plane) return;
        const first = position.length / 3;
        one.points.forEach(p => { position.push(...p); body.push(k); });
        for (const ring of one.faces) {
          for (let i = 1; i < ring.length - 1; ++i) {
            index.push(first + ring[0], first + ring[i], first + ring[i + 1]);
          }
        }
      });
      if (!index.length) return null;
      return this.add(new THREE.Mesh(
        this.geometry(new Float32Array(position), new Float32Array(body), new Uint32Array(index)),
        this.material(floeScene.litShader, this.places.texture, options)), order);
    };
    this.blocks = make(false, {}, 0);
    this.planes = make(true, {transparent: true, depthWrite: false,
                              uniforms: {opacity: {value: 0.35}}}, 3);
  }

  makeWater() {
    const {low, high} = this.extent(), room = 0.15 * Math.hypot(high[0] - low[0], high[1] - low[1]);
    const z = 0;  // its level is that of its pose
    const [x0, y0, x1, y1] = [low[0] - room, low[1] - room, high[0] + room, high[1] + room];
    const position = new Float32Array([x0, y0, z, x1, y0, z, x1, y1, z, x0, y1, z]);
    const pose = floeScene.textureFor(1);
    this.waterPose = pose;
    this.water = this.add(new THREE.Mesh(
      this.geometry(position, new Float32Array(4), new Uint32Array([0, 1, 2, 0, 2, 3])),
      this.material(floeScene.plainShader, pose.texture, {
        transparent: true, depthWrite: false, uniforms: {
          paint: {value: new THREE.Color(0.25, 0.5, 0.7)}, opacity: {value: 0.25}}})), 4);
  }

  makeArrows() {
    const {arrows} = this.scene;
    if (!arrows.length) return;
    const sides = 12, position = [], body = [], index = [];
    // From its tail to its tip at the origin, one long, along +x.
    const rings = [[-1, 0], [-1, 0.035], [-0.3, 0.035], [-0.3, 0.1], [0, 0]];
    arrows.forEach((_, k) => {
      const first = position.length / 3;
      for (const [x, r] of rings) {
        for (let s = 0; s < sides; ++s) {
          const a = 2 * Math.PI * s / sides;
          position.push(x, r * Math.cos(a), r * Math.sin(a));
          body.push(k);
        }
      }
      for (let i = 0; i < rings.length - 1; ++i) {
        for (let s = 0; s < sides; ++s) {
          const a = first + i * sides + s, b = first + i * sides + (s + 1) % sides;
          index.push(a, b, a + sides, b, b + sides, a + sides);
        }
      }
    });
    this.arrowPoses = floeScene.textureFor(arrows.length);
    this.arrows = this.add(new THREE.Mesh(
      this.geometry(new Float32Array(position), new Float32Array(body), new Uint32Array(index)),
      this.material(floeScene.litShader, this.arrowPoses.texture, {depthTest: false,
                                                                   transparent: true})), 5);
    const largest = Math.max(...arrows.flatMap(one => one.force.map(f => Math.hypot(...f))));
    const {low, high} = this.extent();
    this.newtonsPerMetre = largest / (0.22 * Math.max(high[0] - low[0], high[1] - low[1])) || 1;
  }

  // Box around the bodies at the first and the last frame.
  extent() {
    if (this.box) return this.box;
    const low = [Infinity, Infinity, Infinity], high = low.map(v => -v), {scene} = this;
    for (const frame of [0, scene.times.length - 1]) {
      for (let b = 0; b < scene.bodies; ++b) {
        if (!floeScene.exists(scene, frame, b)) continue;
        const {place} = floeScene.bodyPose(scene, frame, b);
        for (let i = 0; i < 3; ++i) {
          low[i] = Math.min(low[i], place[i] - scene.size);
          high[i] = Math.max(high[i], place[i] + scene.size);
        }
      }
    }
    return this.box = {low, high};
  }

  // Looks at the ice from behind, from the side, so that all of it is in the window.
  placeCamera() {
    const {low, high} = this.extent(), flow = this.flow();
    const azimuth = (flow ? Math.atan2(flow[1], flow[0]) : 0) - 2.1, elevation = 0.6;
    const back = new THREE.Vector3(Math.cos(elevation) * Math.cos(azimuth),
                                   Math.cos(elevation) * Math.sin(azimuth), Math.sin(elevation));
    const right = new THREE.Vector3(0, 0, 1).cross(back).normalize();
    const up = back.clone().cross(right);
    const target = new THREE.Vector3(...low.map((v, i) => (v + high[i]) / 2));
    const wide = Math.tan(this.camera.fov * Math.PI / 360);
    const corners = Array.from({length: 8}, (_, k) => new THREE.Vector3(
      ...low.map((v, i) => (k >> i & 1 ? high[i] : v))).sub(target));
    const distance = 1.04 * Math.max(...corners.map(c => c.dot(back) + Math.max(
      Math.abs(c.dot(up)) / wide, Math.abs(c.dot(right)) / (wide * this.camera.aspect))));
    this.camera.position.copy(target).addScaledVector(back, distance);
    this.camera.near = distance / 100;
    this.camera.far = distance * 20;
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(target);
    this.controls.update();
    this.controls.saveState();
  }

  flow() {  // direction in plan of the mean force on obstacles
    const sum = [0, 0];
    for (const one of this.scene.arrows) {
      if (one.kind === 'obstacle') one.force.forEach(f => { sum[0] += f[0]; sum[1] += f[1]; });
    }
    return Math.hypot(...sum) > 0 ? sum : null;
  }

  // -- state ----------------------------------------------------------------------------------
  get time() {
    const k = Math.floor(this.frame), {times} = this.scene;
    const f = this.frame - k;
    return f > 0 ? times[k] + f * (times[k + 1] - times[k]) : times[k];
  }

  setFrame(frame) {
    const last = this.scene.times.length - 1;
    this.frame = Math.min(last, Math.max(0, frame));
    const k = Math.min(Math.floor(this.frame), last), f = this.frame - k;
    floeScene.fillBodies(this.scene, this.poses.data, k, f);
    this.paint();
    this.poses.texture.needsUpdate = true;
    this.placeObstacles(k, f);
    this.placeWater(k, f);
    this.placeArrows(Math.round(this.frame));
    if (this.cracks) this.cracks.material.uniforms.now.value = this.time;
    for (const listener of this.listeners) listener(this);
    this.request();
  }

  setTime(time) {
    const {times} = this.scene;
    let k = 0;
    while (k < times.length - 2 && times[k + 1] <= time) ++k;
    const step = times.length > 1 ? times[k + 1] - times[k] : 1;
    this.setFrame(k + Math.min(1, (time - times[k]) / step));
  }

  setColour(colour) {
    this.colour = colour;
    this.painted = -1;
    this.setFrame(this.frame);
  }

  // Colours that change with the frame, not between frames.
  paint() {
    const k = Math.floor(this.frame + 1e-9), {data} = this.poses, n = this.scene.bodies;
    this.bodies.material.uniforms.byHeight.value = this.colour === 'height' ? 1 : 0;
    if (this.colour === 'height' || this.painted === k) return;
    this.painted = k;
    const put = (b, rgb) => { for (let i = 0; i < 3; ++i) data[12 * b + 8 + i] = rgb[i]; };
    if (this.colour === 'fragment') {
      const {of} = floeScene.fragmentsAt(this.scene, k);
      for (let b = 0; b < n; ++b) {
        put(b, of[b] <= 0 ? [0.80, 0.86, 0.91] : floeScene.hue(of[b], 0.66));
      }
      return;
    }
    const speeds = Array.from({length: n}, (_, b) => Math.hypot(...this.velocityOf(b, k)));
    if (!this.fastest) this.fastest = this.fastSpeed();
    speeds.forEach((v, b) => put(b, floeScene.speedColour(v / this.fastest)));
  }

  fastSpeed() {  // that 99 of 100 bodies keep below at the last frame but one
    const k = Math.max(0, this.scene.times.length - 2);
    const all = Array.from({length: this.scene.bodies}, (_, b) => b).filter(
      b => floeScene.exists(this.scene, k, b)).map(
      b => Math.hypot(...this.velocityOf(b, k))).sort((a, b) => a - b);
    return all[Math.floor(0.99 * (all.length - 1))] || 1;
  }

  // Mean velocity [m/s] from the frame before to the one after.
  velocityOf(b, k) {
    const {times} = this.scene, [first, last] = floeScene.lifeOf(this.scene, b);
    const a = Math.max(first, k - 1), z = Math.min(last, k + 1);
    if (a >= z) return [0, 0, 0];
    const from = floeScene.bodyPose(this.scene, a, b), to = floeScene.bodyPose(this.scene, z, b);
    return to.place.map((v, i) => (v - from.place[i]) / (times[z] - times[a]));
  }

  placeObstacles(k, f) {
    this.scene.obstacles.forEach((one, i) => {
      const pose = at => {
        if (!one.motions.length) return {place: one.origin, turn: [0, 0, 0, 1]};
        const [way, turn] = one.motions[at];
        return {place: one.origin.map((v, j) => v + way[j]),
                turn: floeScene.quaternionOfMatrix(turn)};
      };
      const here = pose(k);
      floeScene.put(this.places.data, i, f > 0 ? floeScene.between(here, pose(k + 1), f) : here, 1,
                    [0.50, 0.48, 0.46]);
    });
    if (this.places) this.places.texture.needsUpdate = true;
  }

  placeWater(k, f) {
    const {levels, origin} = this.scene;
    const z = !levels ? -origin[2] :
      f > 0 ? levels[k] + f * (levels[k + 1] - levels[k]) : levels[k];
    this.bodies.material.uniforms.level.value = z;
    if (!this.water) return;
    floeScene.put(this.waterPose.data, 0, {place: [0, 0, z], turn: [0, 0, 0, 1]}, 1, [0, 0, 0]);
    this.waterPose.texture.needsUpdate = true;
  }

  placeArrows(k) {
    this.scene.arrows.forEach((one, i) => {
      const force = one.force[k], size = Math.hypot(...force), at = one.at[k];
      const turn = new THREE.Quaternion().setFromUnitVectors(
        new THREE.Vector3(1, 0, 0), new THREE.Vector3(...force).normalize());
      const pose = {place: at || [0, 0, 0], turn: [turn.x, turn.y, turn.z, turn.w]};
      floeScene.put(this.arrowPoses.data, i, pose, at ? size / this.newtonsPerMetre : 0,
                    one.kind === 'obstacle' ? [0.06, 0.62, 0.22] : [0.45, 0.25, 0.75]);
    });
    if (this.arrowPoses) this.arrowPoses.texture.needsUpdate = true;
  }

  objectsOf(what) {
    return {cracks: [this.cracks], arrows: [this.arrows], water: [this.water],
            obstacles: [this.blocks, this.planes], edges: [this.edges]}[what].filter(Boolean);
  }

  show(what, visible) {
    for (const object of this.objectsOf(what)) object.visible = visible;
    this.request();
  }

  // -- play and draw --------------------------------------------------------------------------
  play() {
    if (this.frame >= this.scene.times.length - 1 - 1e-9) this.setFrame(0);
    this.playing = true;
    this.last = null;
    this.request();
    for (const listener of this.listeners) listener(this);
  }

  pause() {
    this.playing = false;
    for (const listener of this.listeners) listener(this);
  }

  request() {
    if (!this.waiting) {
      this.waiting = true;
      requestAnimationFrame(now => this.draw(now));
    }
  }

  // Whether the graphics card has done what it was told last. Without this question a slow one is
  // given frames faster than it draws, and the rate would be that of giving.
  cardIsFree() {
    if (!this.fence) return true;
    const gl = this.renderer.getContext();
    if (gl.clientWaitSync(this.fence, 0, 0) === gl.TIMEOUT_EXPIRED) return false;
    gl.deleteSync(this.fence);
    this.fence = null;
    return true;
  }

  draw(now) {
    this.waiting = false;
    if (!this.cardIsFree()) {
      this.request();
      return;
    }
    if (this.playing) {
      if (this.last !== null) this.setTime(this.time + this.speed * (now - this.last) / 1000);
      this.last = now;
      if (this.frame >= this.scene.times.length - 1 - 1e-9) this.pause();
      else this.request();
    }
    this.renderer.render(this.world, this.camera);
    const gl = this.renderer.getContext();
    this.fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    this.measure(now);
  }

  // Frames a second, over half a second and more in which one frame follows the other.
  measure(now) {
    const {calls, triangles} = this.renderer.info.render;
    this.calls = calls;
    this.triangles = triangles;
    if (!this.since || now - this.before > (this.playing ? 10000 : 400)) {
      this.since = now;
      this.drawn = 0;
    } else {
      this.drawn += 1;
      if (now - this.since >= 500) {
        this.rate = 1000 * this.drawn / (now - this.since);
        this.since = now;
        this.drawn = 0;
        if (this.onRate) this.onRate(this);
      }
    }
    this.before = now;
  }

  resize() {
    const width = this.parent.clientWidth, height = this.parent.clientHeight;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    // A narrow window sees as much across as a wide one.
    this.camera.fov = 35 * Math.min(2, Math.max(1, 1.25 / this.camera.aspect));
    this.camera.updateProjectionMatrix();
    this.request();
  }

  // -- pick -----------------------------------------------------------------------------------
  released(event) {
    const [x, y] = this.pressed || [0, 0];
    if (Math.hypot(event.clientX - x, event.clientY - y) > 5) return;  // it was a turn
    const box = this.canvas.getBoundingClientRect();
    this.select(this.bodyAt((event.clientX - box.left) / box.width,
                            (event.clientY - box.top) / box.height));
  }

  // The body seen at a place of the window, from 0, 0 (top left) to 1, 1; -1: none.
  bodyAt(across, down) {
    const caster = new THREE.Raycaster();
    this.camera.updateMatrixWorld();
    caster.setFromCamera(new THREE.Vector2(2 * across - 1, 1 - 2 * down), this.camera);
    const {origin, direction} = caster.ray, {data} = this.poses;
    const o = new THREE.Vector3(), d = new THREE.Vector3(), q = new THREE.Quaternion();
    let best = Infinity, found = -1;
    for (let b = 0; b < this.scene.bodies; ++b) {
      const at = 12 * b;
      if (data[at + 3] === 0) continue;  // it does not exist
      o.set(origin.x - data[at], origin.y - data[at + 1], origin.z - data[at + 2]);
      const along = o.dot(direction), radius = this.mesh.radius[b];
      if (o.lengthSq() - along * along > radius * radius) continue;
      q.set(-data[at + 4], -data[at + 5], -data[at + 6], data[at + 7]);  // into the body's frame
      const {planes, planeOf} = this.mesh;
      const distance = this.entry(planes, planeOf[b], planeOf[b + 1], o.applyQuaternion(q),
                                  d.copy(direction).applyQuaternion(q));
      if (distance < best) [best, found] = [distance, b];
    }
    return this.hidden(caster.ray, best) ? -1 : found;
  }

  // Whether an obstacle that is no plane is nearer than this on a ray.
  hidden({origin, direction}, distance) {
    if (!this.blocks || !this.blocks.visible) return false;
    const {data} = this.places;
    return this.scene.obstacles.some((one, i) => {
      if (one.plane) return false;
      one.walls ||= one.faces.flatMap(
        ring => floeScene.planeThrough(one.points.flat(), ring));
      const at = 12 * i, o = origin.clone().sub(
        new THREE.Vector3(data[at], data[at + 1], data[at + 2]));
      const q = new THREE.Quaternion(-data[at + 4], -data[at + 5], -data[at + 6], data[at + 7]);
      return this.entry(one.walls, 0, one.faces.length, o.applyQuaternion(q),
                        direction.clone().applyQuaternion(q)) < distance;
    });
  }

  // Where a ray enters what is within these planes; Infinity if it misses it.
  entry(planes, first, end, o, d) {
    let from = -Infinity, to = Infinity;
    for (let k = 4 * first; k < 4 * end; k += 4) {
      const speed = planes[k] * d.x + planes[k + 1] * d.y + planes[k + 2] * d.z;
      const room = planes[k + 3] - planes[k] * o.x - planes[k + 1] * o.y - planes[k + 2] * o.z;
      if (Math.abs(speed) < 1e-12) {
        if (room < 0) return Infinity;
      } else if (speed < 0) from = Math.max(from, room / speed);
      else to = Math.min(to, room / speed);
    }
    return from <= to && from > 0 ? from : Infinity;
  }

  select(b) {
    this.selected = b;
    for (const object of [this.bodies]) object.material.uniforms.selected.value = b < 0 ? -5 : b;
    for (const listener of this.listeners) listener(this);
    this.request();
  }

  // Numbers of a body at the nearest frame, or null.
  numbersOf(b) {
    const k = Math.round(this.frame), {scene} = this;
    if (b < 0 || !floeScene.exists(scene, k, b)) return null;
    const pose = floeScene.bodyPose(scene, k, b);
    if (!this.pieces || this.pieces.frame !== k) {
      this.pieces = {frame: k, ...floeScene.fragmentsAt(scene, k)};
    }
    const number = this.pieces.of[b], n = scene.bodies, p = scene.poses, at = 6 * n * k + b;
    const turn = [3, 4, 5].map(i => p[at + i * n] * scene.turn_step);
    return {
      body: scene.ids ? scene.ids[b] : b, mass: scene.masses[b], time: scene.times[k],
      place: pose.place.map((v, i) => v + scene.origin[i]), velocity: this.velocityOf(b, k),
      turn: Math.hypot(...turn) * 180 / Math.PI, fragment: number + 1,
      fragments: this.pieces.pieces.length, ...{
        fragmentBodies: this.pieces.pieces[number].bodies,
        fragmentMass: this.pieces.pieces[number].mass}};
  }
}

// The interactive view: scenes of bodies, and the stored frames of the beat. Data: <script id="scene">.
(function () {
  'use strict';
  const place = document.getElementById('viewer');
  if (!place) return;
  const data = JSON.parse(document.getElementById('scene').textContent);

  function bytes(text) {
    const raw = atob(text), out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; ++i) out[i] = raw.charCodeAt(i);
    return out;
  }
  function positions(text, low, extent) {
    const q = new Uint16Array(bytes(text).buffer), out = new Float32Array(q.length);
    for (let i = 0; i < q.length; ++i) out[i] = low[i % 3] + q[i] / 65535 * extent[i % 3];
    return out;
  }
  function add(parent, tag, properties) {
    const e = Object.assign(document.createElement(tag), properties);
    parent.append(e);
    return e;
  }

  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({antialias: true, alpha: true});
  } catch (error) {
    place.textContent = 'This browser has no WebGL; the pictures of this page show the same states.';
    place.dataset.state = 'no WebGL';
    return;
  }
  place.textContent = '';
  renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
  const top = add(place, 'div', {className: 'row'});
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute('aria-label', 'Three-dimensional view; drag to rotate, scroll to zoom, right drag to move');
  place.append(canvas);
  const toggles = add(place, 'div', {className: 'row'});
  const beatRow = add(place, 'div', {className: 'row'});

  const world = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(30, 16 / 10, 1, 2000);
  camera.up.set(0, 0, 1);
  world.add(new THREE.HemisphereLight(0xffffff, 0x666677, 0.75));
  const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
  world.add(camera);
  camera.add(lamp);
  lamp.position.set(-40, 60, 30);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.addEventListener('change', draw);

  const meshes = data.bodies.map(body => {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(positions(body.points, body.low, body.extent), 3));
    geometry.setIndex(new THREE.BufferAttribute(new (body.index_bits === 16 ? Uint16Array : Uint32Array)(bytes(body.triangles).buffer), 1));
    geometry.computeVertexNormals();
    const seeThrough = body.opacity < 1;
    const material = new THREE.MeshPhongMaterial({
      color: body.colour, side: THREE.DoubleSide, shininess: 25, specular: 0x222222,
      transparent: seeThrough, opacity: body.opacity, depthWrite: !seeThrough
    });
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = seeThrough ? 2 : 0;
    mesh.visible = false;
    world.add(mesh);
    return mesh;
  });

  // The plane of the slice, coloured by speed.
  const beat = data.beat;
  let slice = null;
  if (beat && beat.slices) {
    const pixels = new Uint8Array(4 * beat.nx * beat.nz);
    const texture = new THREE.DataTexture(pixels, beat.nx, beat.nz, THREE.RGBAFormat);
    texture.magFilter = texture.minFilter = THREE.LinearFilter;
    const w = (beat.nx - 1) * beat.spacing[0], h = (beat.nz - 1) * beat.spacing[2];
    const geometry = new THREE.PlaneBufferGeometry(w, h);
    geometry.rotateX(Math.PI / 2);
    geometry.translate(beat.origin[0] + w / 2, beat.origin[1], beat.origin[2] + h / 2);
    slice = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({
      map: texture, side: THREE.DoubleSide, transparent: true, depthWrite: false
    }));
    slice.renderOrder = 1;
    slice.visible = false;
    world.add(slice);
  }
  function heat(t) {
    const x = t * (data.heat.length - 1), i = Math.min(Math.floor(x), data.heat.length - 2), w = x - i;
    return [0, 1, 2].map(c => 255 * ((1 - w) * data.heat[i][c] + w * data.heat[i + 1][c]));
  }
  function paintSlice(frame) {
    const values = bytes(beat.slices[frame]), pixels = slice.material.map.image.data;
    for (let i = 0; i < values.length; ++i) {
      const t = Math.max(0, values[i] - 1) / 254, c = heat(t);
      pixels.set([c[0], c[1], c[2], values[i] ? 255 * Math.min(0.95, 4.5 * t) : 0], 4 * i);
    }
    slice.material.map.needsUpdate = true;
  }

  function showFrame(frame) {
    const geometry = meshes[beat.valve].geometry;
    geometry.attributes.position.array.set(positions(beat.points[frame], beat.low, beat.extent));
    geometry.attributes.position.needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
    if (slice) paintSlice(frame);
    beatRow.querySelector('output').textContent = beat.time_s[frame].toFixed(3) + ' s';
    draw();
  }

  let timer = 0;
  function stop() {
    clearInterval(timer);
    timer = 0;
  }
  function buildBeatRow() {
    beatRow.textContent = '';
    stop();
    const play = add(beatRow, 'button', {type: 'button', textContent: 'Play'});
    const slider = add(beatRow, 'input', {type: 'range', min: 0, max: beat.time_s.length - 1, value: 0});
    slider.setAttribute('aria-label', 'Time of the beat');
    add(beatRow, 'output', {});
    if (slice) add(beatRow, 'span', {textContent: 'colour: 0 to ' + beat.fastest_cm_per_s.toFixed(0) + ' cm/s'});
    slider.oninput = () => showFrame(+slider.value);
    play.onclick = () => {
      if (timer) {
        stop();
      } else {
        timer = setInterval(() => {
          slider.value = (+slider.value + 1) % beat.time_s.length;
          showFrame(+slider.value);
        }, 120);
      }
      play.textContent = timer ? 'Stop' : 'Play';
    };
    showFrame(0);
  }

  function toggle(label, object, on) {
    const l = add(toggles, 'label', {});
    const box = add(l, 'input', {type: 'checkbox', checked: on});
    l.append(' ' + label);
    object.visible = on;
    box.onchange = () => { object.visible = box.checked; draw(); };
  }
  function frameScene(indices) {
    const box = new THREE.Box3();
    const solid = indices.filter(i => data.bodies[i].id !== 'lumen');
    for (const i of (solid.length ? solid : indices)) box.expandByObject(meshes[i]);
    const centre = box.getCenter(new THREE.Vector3()), radius = box.getSize(new THREE.Vector3()).length() / 2;
    controls.target.copy(centre);
    camera.position.copy(centre).add(new THREE.Vector3(0.35, -1, 0.45).normalize().multiplyScalar(radius * 3.9));
    controls.update();
  }
  function show(scene) {
    for (const mesh of meshes) mesh.visible = false;
    if (slice) slice.visible = false;
    toggles.textContent = beatRow.textContent = '';
    stop();
    for (const i of scene.bodies) toggle(data.bodies[i].label, meshes[i], !scene.hidden.includes(i));
    if (scene.beat && beat) {
      if (slice) toggle('Speed in the plane', slice, true);
      buildBeatRow();
    }
    frameScene(scene.bodies);
    draw();
  }
  function draw() {
    renderer.render(world, camera);
  }
  function resize() {
    const width = place.clientWidth - 20, height = Math.round(Math.min(width * 0.62, 620));
    if (width <= 0) return;
    camera.aspect = width / height;
    camera.updateProjectionMatrix();
    renderer.setSize(width, height);
    draw();
  }

  add(top, 'label', {textContent: 'Show', htmlFor: 'which'});
  const which = add(top, 'select', {id: 'which'});
  data.scenes.forEach((scene, i) => add(which, 'option', {value: i, textContent: scene.name}));
  which.onchange = () => show(data.scenes[+which.value]);
  add(top, 'span', {className: 'quiet', textContent: 'drag: rotate · wheel or pinch: zoom · right drag: move'});
  window.addEventListener('resize', resize);
  which.value = data.scenes.length - 1;
  show(data.scenes[data.scenes.length - 1]);
  resize();
  place.dataset.state = 'drawn';
})();

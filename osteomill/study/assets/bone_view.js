// Reads a page's data, and shows its bodies in 3D, with rotation and zoom by mouse and touch.
window.Osteomill = (function () {
  "use strict";
  const D = JSON.parse(document.getElementById("page-data").textContent);

  function bytes(text) {
    const raw = atob(text), all = new Uint8Array(raw.length);
    for (let n = 0; n < raw.length; ++n) all[n] = raw.charCodeAt(n);
    return all.buffer;
  }
  const floats = text => new Float32Array(bytes(text));

  function el(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) {
      if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
      else if (value === true) element.setAttribute(key, "");
      else if (value !== false && value !== null && value !== undefined) element.setAttribute(key, value);
    }
    element.append(...children);
    return element;
  }

  const palette = [[0, 0xa50026], [0.5, 0xf46d43], [1, 0xfee090], [2, 0xabd9e9], [4, 0x4575b4], [8, 0x313695]];
  function thicknessColour(mm) {
    let n = 1;
    while (n < palette.length - 1 && mm > palette[n][0]) ++n;
    const [low, from] = palette[n - 1], [high, to] = palette[n];
    return new THREE.Color(from).lerp(new THREE.Color(to), Math.min(1, (mm - low) / (high - low)));
  }

  function meshOf(body) {
    const places = new Uint16Array(bytes(body.places)), corners = new Float32Array(places.length);
    for (let n = 0; n < places.length; ++n) corners[n] = body.origin[n % 3] + body.step * places[n];
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(corners, 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint16Array(bytes(body.triangles)), 1));
    geometry.computeVertexNormals();
    if (body.kind === "left") {
      // Offset along the normals; otherwise the bone's surface hides it in patches.
      const normals = geometry.getAttribute("normal").array;
      for (let n = 0; n < corners.length; ++n) corners[n] += 0.02 * D.radius * normals[n];
    }
    const clear = body.opacity < 1;
    // These surfaces nearly coincide: draw the remaining and the removed bone in front of the target.
    const offset = { left: -2, outside: -2, target: 6 }[body.kind] || 0;
    const material = new THREE.MeshLambertMaterial({ color: body.colour, transparent: clear, opacity: body.opacity, depthWrite: !clear, side: THREE.DoubleSide,
      polygonOffset: body.kind !== "bone", polygonOffsetFactor: offset, polygonOffsetUnits: offset });
    if (body.thickness) {
      const left = new Uint8Array(bytes(body.thickness)), colours = new Float32Array(3 * left.length), own = new THREE.Color(body.colour);
      left.forEach((value, n) => (value === 255 ? own : thicknessColour(value / 31)).toArray(colours, 3 * n));
      geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    }
    const mesh = new THREE.Mesh(geometry, material);
    mesh.renderOrder = { structure: 0, left: 1, outside: 2, target: 3, keep: 3, bone: 4 }[body.kind];
    if (body.kind === "bone") {
      // Shows only the bone's front surface, not the cavities behind it.
      const front = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ colorWrite: false, side: THREE.DoubleSide, transparent: true }));
      front.renderOrder = 3.5;
      mesh.add(front);
    }
    return mesh;
  }

  // Adds controls to the bar: visibility of the bodies, choice, opacity and colours.
  function addControls(bar, layers, draw) {
    const choices = [...new Set(D.bodies.map(body => body.choice).filter(choice => choice))];
    const pick = el("select", { id: "choice", "aria-label": "Which bone", onchange: () => refresh() },
      ...choices.map((choice, n) => el("option", { value: choice, selected: n === choices.length - 1 }, choice)));
    if (choices.length > 1) bar.append(pick);
    const boxes = new Map();
    function refresh() {
      for (const { body, mesh } of layers) mesh.visible = boxes.get(body.name).checked && (!body.choice || body.choice === pick.value);
      draw();
    }
    for (const { body } of layers) {
      if (boxes.has(body.name)) continue;
      const box = el("input", { type: "checkbox", checked: body.shown, onchange: refresh });
      const swatch = el("span", { class: "swatch" });
      swatch.style.background = body.colour;
      boxes.set(body.name, box);
      bar.append(el("label", {}, box, swatch, body.name));
    }
    refresh();
    const bones = layers.filter(layer => layer.body.kind === "bone");
    if (bones.length) {
      const opacity = el("input", { type: "range", id: "opacity", min: 0.05, max: 1, step: 0.05, value: bones[0].body.opacity, style: "max-width:140px", oninput: () => {
        const value = Number(opacity.value);
        for (const { mesh } of bones) {
          mesh.material.transparent = value < 1;
          mesh.material.depthWrite = value === 1;
          mesh.material.opacity = value;
          mesh.material.needsUpdate = true;
        }
        draw();
      } });
      bar.append(el("label", {}, "bone's opacity", opacity));
    }
    const coloured = layers.filter(layer => layer.body.thickness);
    if (!coloured.length) return;
    const set = on => {
      for (const { body, mesh } of coloured) {
        mesh.material.vertexColors = on ? THREE.VertexColors : THREE.NoColors;
        mesh.material.color.set(on ? 0xffffff : body.colour);
        mesh.material.needsUpdate = true;
      }
      draw();
    };
    const scale = el("i");
    scale.style.background = "linear-gradient(90deg," + palette.slice(0, 5).map(([mm, c]) => "#" + ("00000" + c.toString(16)).slice(-6) + " " + 25 * mm + "%").join(",") + ")";
    bar.append(el("label", {}, el("input", { type: "checkbox", id: "thickness", checked: true, onchange: event => set(event.target.checked) }), "bone thickness over structures"),
      el("span", { class: "scale" }, "0", scale, "4 mm"));
    set(true);
  }

  // Shows the bodies in an element, before one of its children or at its end. Returns the view's parts, and
  // `place`, a function called before each frame that may place the camera and then returns true. Null without WebGL.
  function showBone(here, before) {
    let renderer;
    try {
      renderer = new THREE.WebGLRenderer({ antialias: true });
    } catch (refused) {
      return null;
    }
    const frame = el("div", { class: "view" }, renderer.domElement), bar = el("div", { class: "bar", id: "layers" });
    for (const part of [frame, bar]) here.insertBefore(part, before || null);
    renderer.setClearColor(0xeef1f4);
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    const scene = new THREE.Scene(), camera = new THREE.PerspectiveCamera(30, 1, 0.1, 1000);
    const focus = new THREE.Vector3(...D.focus), up = new THREE.Vector3(...D.up);
    const aside = new THREE.Vector3(Math.abs(up.x) < 0.6 ? 1 : 0, Math.abs(up.x) < 0.6 ? 0 : 1, 0).cross(up).normalize();
    camera.up.copy(up);
    camera.position.copy(focus).addScaledVector(up.clone().addScaledVector(aside, 0.6).normalize(), 5.4 * D.radius);
    const lamp = new THREE.DirectionalLight(0xffffff, 0.55);
    lamp.position.set(-0.4, 0.6, 1);
    camera.add(lamp);
    scene.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.75), camera);
    const controls = new THREE.OrbitControls(camera, renderer.domElement);
    controls.enableKeys = false;
    controls.target.copy(focus);
    controls.screenSpacePanning = true;
    controls.minDistance = 0.5 * D.radius;
    controls.maxDistance = 30 * D.radius;

    let pending = false;
    function draw() {
      if (pending) return;
      pending = true;
      requestAnimationFrame(() => { pending = false; render(); });
    }
    function render() {
      const wide = frame.clientWidth, high = frame.clientHeight, size = renderer.getSize(new THREE.Vector2());
      if (size.x !== wide || size.y !== high) renderer.setSize(wide, high, false);
      controls.enabled = !view.place();
      if (controls.enabled) {
        camera.fov = 30;
        controls.update();
      }
      camera.aspect = wide / high;
      const away = camera.position.distanceTo(focus);
      camera.near = Math.max(0.05, (away - 6 * D.radius) / 2);
      camera.far = away + 12 * D.radius;
      camera.updateProjectionMatrix();
      renderer.render(scene, camera);
    }
    const view = { frame, bar, scene, camera, draw, canvas: renderer.domElement, place: () => false };
    const layers = D.bodies.map(body => ({ body, mesh: meshOf(body) }));
    for (const { mesh } of layers) scene.add(mesh);
    addControls(bar, layers, draw);
    controls.addEventListener("change", draw);
    addEventListener("resize", draw);
    // For tests: projection to the screen.
    window.osteomillPage = { camera };
    return view;
  }

  return { data: D, floats, el, showBone };
})();


// Scenes in space: triangles by a depth buffer, so that nothing but a canvas is needed.
(function () {
  'use strict';
  var PAPER = { light: [255, 255, 255], dark: [21, 24, 28] };
  var HEIGHT = 460, PAPER_PX = 660, SIGHT = 0.6, NONE = 255, SHADES = 250;
  var printing = false;

  function paper() { return truecutColours.dark.matches && !printing ? PAPER.dark : PAPER.light; }

  function bytes(text) {
    var raw = atob(text), out = new Uint8Array(raw.length), i;
    for (i = 0; i < raw.length; i++) { out[i] = raw.charCodeAt(i); }
    return out;
  }

  function unpack(thing) {
    var steps = new Uint16Array(bytes(thing.points).buffer), out = new Float32Array(steps.length), i;
    for (i = 0; i < steps.length; i++) { out[i] = thing.low[i % 3] + thing.size[i % 3] * steps[i] / 65535; }
    thing.at = out;
    thing.seen = new Float32Array(out.length);
  }

  // Rows of the rotation of a quaternion, and the place.
  function matrix(p, k) {
    var x = p[k + 3], y = p[k + 4], z = p[k + 5], w = p[k + 6];
    return [
      1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), p[k],
      2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), p[k + 1],
      2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), p[k + 2]
    ];
  }

  var STILL = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];

  function poseOf(data, thing, moment) {
    return thing.body === null ? STILL : matrix(data.poses[moment], 7 * thing.body);
  }

  // The box of what is shown, over all moments.
  function bounds(data) {
    var low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    var step = Math.max(1, Math.floor(data.poses.length / 8));
    data.meshes.concat(data.lines).forEach(function (thing) {
      var moment, m, i, k, v;
      if (data.groups[thing.group].hidden) { return; }
      for (moment = 0; moment < data.poses.length || moment === 0; moment += step) {
        m = poseOf(data, thing, moment);
        for (i = 0; i < 8; i++) {
          for (k = 0; k < 3; k++) {
            v = m[4 * k + 3];
            for (var axis = 0; axis < 3; axis++) {
              v += m[4 * k + axis] * (thing.low[axis] + ((i >> axis) & 1) * thing.size[axis]);
            }
            low[k] = Math.min(low[k], v);
            high[k] = Math.max(high[k], v);
          }
        }
      }
    });
    return low[0] > high[0] ? [[-1, -1, -1], [1, 1, 1]] : [low, high];
  }

  function home(data) {
    var box = bounds(data), c, d, far, size;
    c = [0, 1, 2].map(function (k) { return 0.5 * (box[0][k] + box[1][k]); });
    size = Math.hypot(box[1][0] - box[0][0], box[1][1] - box[0][1], box[1][2] - box[0][2]);
    d = [1, -1.6, 0.9];
    if (data.camera) {
      d = [0, 1, 2].map(function (k) { return data.camera[0][k] - data.camera[1][k]; });
    }
    far = Math.hypot(d[0], d[1], d[2]) || 1;
    return {
      target: c, far: 0.92 * size, size: size,
      turn: Math.atan2(d[1], d[0]), rise: Math.asin(Math.max(-1, Math.min(1, d[2] / far)))
    };
  }

  // Axes of the eye: right, up, and away from the scene.
  function axes(look) {
    var ct = Math.cos(look.turn), st = Math.sin(look.turn), cr = Math.cos(look.rise), sr = Math.sin(look.rise);
    return [[-st, ct, 0], [-sr * ct, -sr * st, cr], [cr * ct, cr * st, sr]];
  }

  // Moves points into the frame of the eye: x to the right, y up, z the distance.
  function see(thing, m, frame, look) {
    var n = [], i, x, y, z, k, r, at = thing.at, out = thing.seen;
    for (k = 0; k < 3; k++) {
      r = frame[k];
      for (i = 0; i < 4; i++) { n.push(r[0] * m[i] + r[1] * m[4 + i] + r[2] * m[8 + i]); }
      n[4 * k + 3] -= r[0] * look.target[0] + r[1] * look.target[1] + r[2] * look.target[2];
    }
    for (i = 0; i < at.length; i += 3) {
      x = at[i]; y = at[i + 1]; z = at[i + 2];
      out[i] = n[0] * x + n[1] * y + n[2] * z + n[3];
      out[i + 1] = n[4] * x + n[5] * y + n[6] * z + n[7];
      out[i + 2] = look.far - (n[8] * x + n[9] * y + n[10] * z + n[11]);
    }
  }

  function Picture(width, height) {
    this.width = width;
    this.height = height;
    this.image = new ImageData(width, height);
    this.pixels = new Uint32Array(this.image.data.buffer);
    // One over the distance: it is even over the screen.
    this.near = new Float32Array(width * height);
  }

  function packed(rgb, light) {
    return (255 << 24 | Math.min(255, rgb[2] * light) << 16 | Math.min(255, rgb[1] * light) << 8 | Math.min(255, rgb[0] * light)) >>> 0;
  }

  Picture.prototype.triangle = function (p, a, b, c, focus, colour) {
    var w = this.width, h = this.height, near = this.near, pixels = this.pixels;
    var za = 1 / p[a + 2], zb = 1 / p[b + 2], zc = 1 / p[c + 2];
    var xa = w / 2 + focus * p[a] * za, ya = h / 2 - focus * p[a + 1] * za;
    var xb = w / 2 + focus * p[b] * zb, yb = h / 2 - focus * p[b + 1] * zb;
    var xc = w / 2 + focus * p[c] * zc, yc = h / 2 - focus * p[c + 1] * zc;
    var area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya), x0, x1, y0, y1, x, y, row, u, v, z;
    if (!(Math.abs(area) > 1e-9)) { return; }
    x0 = Math.max(0, Math.ceil(Math.min(xa, xb, xc) - 0.5)); x1 = Math.min(w - 1, Math.floor(Math.max(xa, xb, xc) + 0.5));
    y0 = Math.max(0, Math.ceil(Math.min(ya, yb, yc) - 0.5)); y1 = Math.min(h - 1, Math.floor(Math.max(ya, yb, yc) + 0.5));
    for (y = y0; y <= y1; y++) {
      row = y * w;
      for (x = x0; x <= x1; x++) {
        u = ((x - xa) * (yc - ya) - (xc - xa) * (y - ya)) / area;
        v = ((xb - xa) * (y - ya) - (x - xa) * (yb - ya)) / area;
        if (u < -1e-6 || v < -1e-6 || u + v > 1.000001) { continue; }
        z = za + u * (zb - za) + v * (zc - za);
        if (z > near[row + x]) { near[row + x] = z; pixels[row + x] = colour; }
      }
    }
  };

  Picture.prototype.mesh = function (mesh, focus, colours) {
    var p = mesh.seen, t = mesh.corners, i, a, b, c, ux, uy, uz, vx, vy, vz, nx, ny, nz, size, light, shade, rgb;
    for (i = 0; i < t.length; i += 3) {
      a = 3 * t[i]; b = 3 * t[i + 1]; c = 3 * t[i + 2];
      if (p[a + 2] < 1e-3 || p[b + 2] < 1e-3 || p[c + 2] < 1e-3) { continue; }
      ux = p[b] - p[a]; uy = p[b + 1] - p[a + 1]; uz = p[a + 2] - p[b + 2];
      vx = p[c] - p[a]; vy = p[c + 1] - p[a + 1]; vz = p[a + 2] - p[c + 2];
      nx = uy * vz - uz * vy; ny = uz * vx - ux * vz; nz = ux * vy - uy * vx;
      size = Math.hypot(nx, ny, nz) || 1;
      // A lamp a little above and beside the eye; both sides are lit.
      light = 0.45 + 0.6 * Math.abs(0.25 * nx + 0.4 * ny + 0.88 * nz) / size;
      rgb = mesh.rgb;
      if (mesh.shades) {
        shade = Math.max(mesh.shades[t[i]], mesh.shades[t[i + 1]], mesh.shades[t[i + 2]]);
        // Values are read off: the lamp changes them less.
        if (shade !== NONE) {
          light = 0.75 + 0.25 * light;
          rgb = colours[Math.round((mesh.shades[t[i]] + mesh.shades[t[i + 1]] + mesh.shades[t[i + 2]]) / 3)];
        }
      }
      this.triangle(p, a, b, c, focus, packed(rgb, light));
    }
  };

  Picture.prototype.line = function (line, focus, thick) {
    var p = line.seen, w = this.width, h = this.height, i, k, steps, x, y, z, dx, dy, at, colour = packed(line.rgb, 1);
    var xa, ya, za, xb, yb, zb;
    for (i = 3; i < p.length; i += 3) {
      if (p[i - 1] < 1e-3 || p[i + 2] < 1e-3) { continue; }
      // A little nearer than it is, so that a line on a face is seen.
      za = 1.004 / p[i - 1]; zb = 1.004 / p[i + 2];
      xa = w / 2 + focus * p[i - 3] / p[i - 1]; ya = h / 2 - focus * p[i - 2] / p[i - 1];
      xb = w / 2 + focus * p[i] / p[i + 2]; yb = h / 2 - focus * p[i + 1] / p[i + 2];
      steps = Math.min(4096, Math.ceil(Math.max(Math.abs(xb - xa), Math.abs(yb - ya), 1)));
      for (k = 0; k <= steps; k++) {
        x = Math.round(xa + (xb - xa) * k / steps); y = Math.round(ya + (yb - ya) * k / steps); z = za + (zb - za) * k / steps;
        for (dy = 0; dy < thick; dy++) {
          for (dx = 0; dx < thick; dx++) {
            if (x + dx < 0 || x + dx >= w || y + dy < 0 || y + dy >= h) { continue; }
            at = (y + dy) * w + x + dx;
            if (z > this.near[at]) { this.near[at] = z; this.pixels[at] = colour; }
          }
        }
      }
    }
  };

  function draw(scene, fine) {
    var data = scene.data, look = scene.look, canvas = scene.canvas, frame = axes(look), ground = paper();
    var ratio = fine ? 2 : 1, w = Math.round(scene.width * ratio), h = HEIGHT * ratio, picture, focus;
    if (!scene.picture || scene.picture.width !== w) { scene.picture = new Picture(w, h); }
    picture = scene.picture;
    picture.pixels.fill(packed(ground, 1));
    picture.near.fill(0);
    focus = 0.5 * h / SIGHT;
    data.meshes.forEach(function (mesh) {
      var colours = null, k;
      if (data.groups[mesh.group].hidden) { return; }
      if (mesh.shades) {
        for (colours = [], k = 0; k <= SHADES; k++) { colours.push(truecutColours.at(data.scales[mesh.scale], k / SHADES, [235, 235, 235])); }
      }
      see(mesh, poseOf(data, mesh, scene.moment), frame, look);
      picture.mesh(mesh, focus, colours);
    });
    data.lines.forEach(function (line) {
      if (data.groups[line.group].hidden) { return; }
      see(line, poseOf(data, line, scene.moment), frame, look);
      picture.line(line, focus, 2 * ratio - 1);
    });
    canvas.width = w;
    canvas.height = h;
    canvas.getContext('2d').putImageData(picture.image, 0, 0);
    // How much of it is not paper, for whoever cannot see it.
    canvas.dataset.covered = (picture.near.reduce(function (sum, z) { return sum + (z > 0 ? 1 : 0); }, 0) / (w * h)).toFixed(4);
  }

  // Coarse while it moves, fine once it rests.
  function moved(scene) {
    if (!scene.asked) {
      scene.asked = window.requestAnimationFrame(function () { scene.asked = 0; draw(scene, false); });
    }
    window.clearTimeout(scene.rest);
    scene.rest = window.setTimeout(function () { draw(scene, true); }, 200);
  }

  function listen(scene) {
    var canvas = scene.canvas, from = null;
    canvas.addEventListener('pointerdown', function (event) {
      from = event;
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener('pointerup', function () { from = null; });
    canvas.addEventListener('pointercancel', function () { from = null; });
    canvas.addEventListener('pointermove', function (event) {
      var dx, dy, look = scene.look, frame, step;
      if (!from) { return; }
      dx = event.clientX - from.clientX; dy = event.clientY - from.clientY;
      from = event;
      if (event.shiftKey) {
        frame = axes(look);
        step = 2 * SIGHT * look.far / HEIGHT;
        look.target = look.target.map(function (v, k) { return v + step * (dy * frame[1][k] - dx * frame[0][k]); });
      } else {
        look.turn -= 0.008 * dx;
        look.rise = Math.max(-1.57, Math.min(1.57, look.rise + 0.008 * dy));
      }
      moved(scene);
    });
    var zoom = function (factor) {
      scene.look.far = Math.max(0.02 * scene.look.size, Math.min(20 * scene.look.size, scene.look.far * factor));
      moved(scene);
    };
    canvas.addEventListener('wheel', function (event) {
      // A page that is scrolled past stays as it is.
      if (document.activeElement !== canvas) { return; }
      event.preventDefault();
      zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener('dblclick', function () { scene.look = home(scene.data); moved(scene); });
    canvas.addEventListener('keydown', function (event) {
      var look = scene.look, key = event.key;
      if (key === 'ArrowLeft') { look.turn -= 0.1; } else if (key === 'ArrowRight') { look.turn += 0.1; }
      else if (key === 'ArrowUp') { look.rise = Math.min(1.57, look.rise + 0.1); }
      else if (key === 'ArrowDown') { look.rise = Math.max(-1.57, look.rise - 0.1); }
      else if (key === '+') { zoom(0.85); } else if (key === '-') { zoom(1 / 0.85); }
      else { return; }
      event.preventDefault();
      moved(scene);
    });
  }

  function legend(scene) {
    var box = document.createElement('div'), data = scene.data;
    box.className = 'legend';
    data.groups.forEach(function (group) {
      var button = document.createElement('button');
      button.type = 'button';
      button.setAttribute('aria-pressed', String(!group.hidden));
      button.textContent = group.label;
      button.addEventListener('click', function () {
        group.hidden = !group.hidden;
        button.setAttribute('aria-pressed', String(!group.hidden));
        moved(scene);
      });
      box.append(button);
    });
    data.scales.forEach(function (scale) { box.append(truecutColours.bar(scale, [235, 235, 235])); });
    return box;
  }

  function slider(scene) {
    var label = document.createElement('label'), input = document.createElement('input');
    var told = document.createElement('span'), time = scene.data.time;
    input.type = 'range';
    input.min = 0;
    input.max = time.length - 1;
    input.value = scene.moment;
    input.setAttribute('aria-label', 'moment');
    var tell = function () { told.textContent = Number(time[scene.moment].toPrecision(4)) + ' s'; };
    input.addEventListener('input', function () {
      scene.moment = Number(input.value);
      tell();
      moved(scene);
    });
    tell();
    label.append(input, told);
    return label;
  }

  var scenes = [];
  document.querySelectorAll('.space').forEach(function (box) {
    var data = JSON.parse(box.querySelector('script').textContent), scene;
    data.meshes.concat(data.lines).forEach(unpack);
    data.meshes.forEach(function (mesh) {
      var raw = bytes(mesh.triangles).buffer;
      mesh.corners = mesh.wide ? new Uint32Array(raw) : new Uint16Array(raw);
      if (mesh.shades) { mesh.shades = bytes(mesh.shades); }
    });
    scene = { data: data, canvas: document.createElement('canvas'), moment: Math.max(0, data.time.length - 1) };
    scene.canvas.tabIndex = 0;
    scene.canvas.setAttribute('role', 'img');
    scene.canvas.setAttribute('aria-label', box.parentElement.querySelector('figcaption').textContent);
    scene.canvas.style.height = HEIGHT + 'px';
    scene.width = Math.max(280, box.clientWidth);
    scene.look = home(data);
    box.append(scene.canvas, legend(scene));
    if (data.time.length > 1) { box.append(slider(scene)); }
    listen(scene);
    draw(scene, true);
    scenes.push(scene);
  });

  function again() {
    scenes.forEach(function (scene) {
      // As wide as it will be on paper, where the page is narrower.
      scene.width = printing ? PAPER_PX : Math.max(280, scene.canvas.clientWidth);
      draw(scene, true);
    });
  }

  truecutColours.dark.addEventListener('change', again);
  window.addEventListener('beforeprint', function () { printing = true; again(); });
  window.addEventListener('afterprint', function () { printing = false; again(); });
  window.addEventListener('resize', function () {
    scenes.forEach(function (scene) {
      scene.width = Math.max(280, scene.canvas.clientWidth);
      moved(scene);
    });
  });
  document.documentElement.dataset.spaces = String(scenes.length);
  // When all can be used, since the page was asked for.
  document.documentElement.dataset.readyMs = String(Math.round(window.performance.now()));
}());

(function () {
  'use strict';
  var LIGHT = {
    ink: '#444', grid: '#e2e5e9', paper: [255, 255, 255],
    colours: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#000000']
  };
  var DARK = {
    ink: '#b8c0c8', grid: '#323940', paper: [21, 24, 28],
    colours: ['#3c96ff', '#f28e2b', '#28be8c', '#e18cbe', '#e6c200', '#7fd0ff', '#ebebeb']
  };
  var dark = truecutColours.dark;
  var printing = false;
  var HEIGHT = 340;

  function theme() { return dark.matches && !printing ? DARK : LIGHT; }

  function usable(v, log) { return v !== null && isFinite(v) && (!log || v > 0); }

  // All values that an axis has to hold, of one layer.
  function values(layer, axis) {
    var found = layer[axis].slice();
    var half, i;
    if (axis === 'y' && layer.low) { found = found.concat(layer.low); }
    if (axis === 'y' && layer.half) {
      for (i = 0; i < layer.y.length; i++) {
        if (layer.y[i] !== null && layer.half[i] !== null) {
          found.push(layer.y[i] - layer.half[i], layer.y[i] + layer.half[i]);
        }
      }
    }
    if (layer.size) {
      half = layer.size[axis === 'x' ? 0 : 1] / 2;
      layer[axis].forEach(function (v) { if (v !== null) { found.push(v - half, v + half); } });
    }
    return found;
  }

  function range(panel, axis) {
    var log = panel[axis].log, low = Infinity, high = -Infinity, margin;
    panel.layers.forEach(function (layer) {
      values(layer, axis).forEach(function (v) {
        if (usable(v, log)) { low = Math.min(low, v); high = Math.max(high, v); }
      });
    });
    if (low > high) { return log ? [1, 10] : [0, 1]; }
    if (log) {
      if (high < low * 1.0001) { return [low / 2, high * 2]; }
      margin = Math.pow(high / low, 0.03);
      return [low / margin, high * margin];
    }
    if (high - low <= 1e-6 * Math.max(Math.abs(low), Math.abs(high))) {
      margin = 0.5 * Math.max(Math.abs(low), 1e-3);
    } else {
      margin = 0.03 * (high - low);
    }
    return [low - margin, high + margin];
  }

  // Labels have the digits that tell one tick from the next.
  function labels(log) {
    return function (u, ticks, axis, space, step) {
      var largest, digits, exponent;
      // As many decimals as a step has: 0.25 has two.
      var decimals = function (size) {
        var count = 0;
        while (count < 20 && Math.abs(size - Math.round(size)) > 1e-6 * size) { size *= 10; count++; }
        return count;
      };
      if (log) {
        return ticks.map(function (v) {
          if (v === null) { return ''; }
          return v < 1e-3 || v >= 1e6 ? v.toExponential() : String(Number(v.toPrecision(3)));
        });
      }
      largest = Math.max.apply(null, ticks.map(Math.abs));
      if (largest !== 0 && (largest >= 1e6 || largest < 1e-3)) {
        exponent = Math.floor(Math.log10(largest));
        digits = decimals(step / Math.pow(10, exponent));
        return ticks.map(function (v) {
          var own;
          if (Math.abs(v) < step * 1e-6) { return '0'; }
          own = exponent - Math.floor(Math.log10(Math.abs(v)) + 1e-9);
          return v.toExponential(Math.max(0, digits - own));
        });
      }
      digits = decimals(step);
      return ticks.map(function (v) { return v.toFixed(digits); });
    };
  }

  function rising(x) {
    var i;
    for (i = 1; i < x.length; i++) { if (!(x[i] >= x[i - 1])) { return false; } }
    return true;
  }

  // The sample nearest to a place on the screen: by x where a curve goes to the right only.
  function nearest(u, layer, left, top) {
    var x = u.posToVal(left, 'x'), best = -1, least = Infinity, low = 0, high, i, far, dx, dy;
    if (layer.rising) {
      high = layer.x.length;
      while (low < high) {
        i = (low + high) >> 1;
        if (layer.x[i] < x) { low = i + 1; } else { high = i; }
      }
      for (i = Math.max(0, low - 1); i <= low && i < layer.x.length; i++) {
        far = Math.abs(layer.x[i] - x);
        if (far < least && layer.y[i] !== null) { least = far; best = i; }
      }
      return best;
    }
    for (i = 0; i < layer.x.length; i++) {
      if (layer.x[i] === null || layer.y[i] === null) { continue; }
      dx = u.valToPos(layer.x[i], 'x') - left;
      dy = u.valToPos(layer.y[i], 'y') - top;
      far = dx * dx + dy * dy;
      if (far < least) { least = far; best = i; }
    }
    return best;
  }

  // Of a shade of cells: −1 to 1 about nothing, else 0 to 1.
  function shade(value, scale, paper) {
    var share = scale && !scale.diverging ? value : (value + 1) / 2;
    return 'rgb(' + truecutColours.at(scale, share, paper).join(',') + ')';
  }

  // What a shade stands for.
  function meant(value, scale) {
    return scale.low + (scale.diverging ? (value + 1) / 2 : value) * (scale.high - scale.low);
  }

  function paint(u, layer, panel) {
    var ctx = u.ctx, ratio = window.devicePixelRatio || 1, look = theme();
    var colour = look.colours[layer.colour % look.colours.length], i, x, y, open, w, h;
    var px = function (v) { return usable(v, panel.x.log) ? u.valToPos(v, 'x', true) : null; };
    var py = function (v) { return usable(v, panel.y.log) ? u.valToPos(v, 'y', true) : null; };
    var trace = function (ys) {
      ctx.beginPath();
      open = false;
      for (i = 0; i < layer.x.length; i++) {
        x = px(layer.x[i]); y = py(ys[i]);
        if (x === null || y === null) { open = false; continue; }
        if (open) { ctx.lineTo(x, y); } else { ctx.moveTo(x, y); open = true; }
      }
      ctx.stroke();
    };
    var dots = function (radius, filled) {
      for (i = 0; i < layer.x.length; i++) {
        x = px(layer.x[i]); y = py(layer.y[i]);
        if (x === null || y === null) { continue; }
        ctx.beginPath();
        ctx.arc(x, y, radius * ratio, 0, 7);
        if (filled) { ctx.fill(); } else { ctx.stroke(); }
      }
    };
    ctx.strokeStyle = colour;
    ctx.fillStyle = colour;
    ctx.lineJoin = 'round';
    ctx.lineWidth = 1.5 * ratio;
    ctx.setLineDash([]);
    ctx.globalAlpha = 1;
    if (layer.style === 'line' || layer.style === 'dotted' || layer.style === 'dashed') {
      // What was measured lies wide and pale below what is drawn over it.
      if (layer.label === 'measured' && panel.layers.length > 1) {
        ctx.lineWidth = 4 * ratio;
        ctx.globalAlpha = 0.45;
      }
      if (layer.style === 'dotted') { ctx.lineWidth = (layer.width || 2) * ratio; }
      if (layer.style === 'dashed' || layer.colour >= look.colours.length) {
        ctx.setLineDash([6 * ratio, 4 * ratio]);
      }
      trace(layer.y);
      if (layer.style === 'dotted') { dots(2 + (layer.width || 2) / 2, true); }
    } else if (layer.style === 'cloud') {
      ctx.globalAlpha = 0.4;
      dots(1.5, true);
    } else if (layer.style === 'bars') {
      ctx.lineWidth = ratio;
      if (layer.x.length > 2) { trace(layer.y); }
      ctx.lineWidth = 2 * ratio;
      for (i = 0; i < layer.x.length; i++) {
        x = px(layer.x[i]);
        if (x === null || layer.y[i] === null || layer.half[i] === null) { continue; }
        w = py(layer.y[i] - layer.half[i]); h = py(layer.y[i] + layer.half[i]);
        if (w === null || h === null) { continue; }
        ctx.beginPath();
        ctx.moveTo(x, w);
        ctx.lineTo(x, h);
        ctx.stroke();
      }
      dots(3.5, true);
    } else if (layer.style === 'band') {
      band(ctx, layer, px, py);
    } else if (layer.style === 'marks') {
      ctx.lineWidth = 2 * ratio;
      dots(4.5, false);
      ctx.font = 12 * ratio + 'px system-ui, sans-serif';
      ctx.textAlign = 'center';
      layer.texts.forEach(function (text, k) {
        x = px(layer.x[k]); y = py(layer.y[k]);
        if (text && x !== null && y !== null) { ctx.fillText(text, x, Math.max(y - 9 * ratio, u.bbox.top + 12 * ratio)); }
      });
    } else if (layer.style === 'cells') {
      for (i = 0; i < layer.x.length; i++) {
        if (layer.shade[i] === null || layer.x[i] === null || layer.y[i] === null) { continue; }
        x = px(layer.x[i] - layer.size[0] / 2); w = px(layer.x[i] + layer.size[0] / 2) - x;
        y = py(layer.y[i] + layer.size[1] / 2); h = py(layer.y[i] - layer.size[1] / 2) - y;
        ctx.fillStyle = shade(layer.shade[i], panel.scale, look.paper);
        ctx.fillRect(x - 0.5, y - 0.5, w + 1, h + 1);
      }
    }
  }

  function band(ctx, layer, px, py) {
    var strip = [], k;
    var close = function () {
      if (strip.length > 1) {
        ctx.globalAlpha = 0.25;
        ctx.beginPath();
        strip.forEach(function (p, at) {
          if (at) { ctx.lineTo(p[0], p[1]); } else { ctx.moveTo(p[0], p[1]); }
        });
        strip.reverse().forEach(function (p) { ctx.lineTo(p[0], p[2]); });
        ctx.fill();
      }
      strip = [];
    };
    for (k = 0; k < layer.x.length; k++) {
      var at = [px(layer.x[k]), py(layer.y[k]), py(layer.low[k])];
      if (at[0] === null || at[1] === null || at[2] === null) { close(); } else { strip.push(at); }
    }
    close();
  }

  function paintAll(panel) {
    return function (u) {
      var box = u.bbox;
      u.ctx.save();
      u.ctx.beginPath();
      u.ctx.rect(box.left, box.top, box.width, box.height);
      u.ctx.clip();
      panel.layers.forEach(function (layer) { if (!layer.hidden) { paint(u, layer, panel); } });
      u.ctx.restore();
    };
  }

  function shown(v) { return String(Number(v.toPrecision(6))); }

  function legend(panel, redraw) {
    var box = document.createElement('div');
    box.className = 'legend';
    panel.layers.forEach(function (layer) {
      var button, swatch, look = theme();
      if (!layer.label) { return; }
      button = document.createElement('button');
      button.type = 'button';
      button.setAttribute('aria-pressed', String(!layer.hidden));
      swatch = document.createElement('i');
      swatch.style.borderTopColor = look.colours[layer.colour % look.colours.length];
      layer.told = document.createElement('span');
      button.append(swatch, layer.label, layer.told);
      button.addEventListener('click', function () {
        layer.hidden = !layer.hidden;
        button.setAttribute('aria-pressed', String(!layer.hidden));
        redraw();
      });
      box.append(button);
    });
    panel.told = document.createElement('span');
    box.append(panel.told);
    return box;
  }

  function hover(panel) {
    return function (u) {
      var left = u.cursor.left, top = u.cursor.top, place = '';
      panel.layers.forEach(function (layer) {
        var at = left >= 0 && !layer.hidden && layer.told ? nearest(u, layer, left, top) : -1;
        if (layer.told) {
          layer.told.textContent = at < 0 ? '' : ': ' + shown(panel.scale && layer.shade ? meant(layer.shade[at], panel.scale) : layer.y[at]);
        }
        if (at >= 0) {
          place = panel.x.label + ' ' + shown(layer.x[at]);
          if (panel.scale) { place += ', ' + panel.y.label + ' ' + shown(layer.y[at]); }
        }
      });
      panel.told.textContent = place;
    };
  }

  // A view in one scale is as high as it is beside its width, within what a page bears.
  function height(panel, full, width) {
    if (!panel.even) { return HEIGHT; }
    var ratio = (full.y[1] - full.y[0]) / (full.x[1] - full.x[0]);
    return Math.round(Math.max(180, Math.min(640, 60 + ratio * (width - 90))));
  }

  function plot(panel, box, width) {
    var full = { x: range(panel, 'x'), y: range(panel, 'y') }, look = theme(), u;
    var scale = function (axis) {
      return {
        time: false, distr: panel[axis].log ? 3 : 1,
        range: function () { return full[axis]; }
      };
    };
    var axis = function (name, size) {
      return {
        label: panel[name].label, stroke: look.ink, size: size, values: labels(panel[name].log),
        grid: { stroke: look.grid, width: 1 }, ticks: { stroke: look.grid, width: 1 }
      };
    };
    u = new uPlot({
      width: width, height: height(panel, full, width), legend: { show: false },
      cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false } },
      scales: { x: scale('x'), y: scale('y') },
      axes: [axis('x', 44), axis('y', 72)],
      series: [{}, { paths: function () { return null; }, points: { show: false } }],
      hooks: { draw: [paintAll(panel)], setCursor: [hover(panel)] }
    }, [full.x, full.y], box);
    u.over.addEventListener('dblclick', function () {
      u.setScale('x', { min: full.x[0], max: full.x[1] });
      u.setScale('y', { min: full.y[0], max: full.y[1] });
    });
    return u;
  }

  var plots = [];

  function build() {
    plots.forEach(function (one) { one.u.destroy(); one.head.remove(); });
    plots = [];
    document.querySelectorAll('.panel').forEach(function (box) {
      var panel = box.panel, u, head;
      var width = printing ? 660 : Math.max(280, box.clientWidth);
      if (!panel) {
        panel = box.panel = JSON.parse(box.querySelector('script').textContent);
        panel.layers.forEach(function (layer) { layer.rising = rising(layer.x); });
      }
      head = legend(panel, function () { u.redraw(); });
      if (panel.scale) { head.append(truecutColours.bar(panel.scale, theme().paper)); }
      box.append(head);
      u = plot(panel, box, width);
      plots.push({ u: u, head: head, box: box });
    });
    document.documentElement.dataset.panels = String(plots.length);
  }

  build();
  dark.addEventListener('change', build);
  window.addEventListener('beforeprint', function () { printing = true; build(); });
  window.addEventListener('afterprint', function () { printing = false; build(); });
  window.addEventListener('resize', function () {
    plots.forEach(function (one) {
      var width = Math.max(280, one.box.clientWidth);
      if (width !== one.u.width) { one.u.setSize({ width: width, height: one.u.height }); }
    });
  });
}());


// What figures and scenes share: colours of paper and of maps, and the bar that says what they mean.
var truecutColours = (function () {
  'use strict';
  // viridis of matplotlib, five of its colours: even steps of lightness, legible without colour vision
  var RUN = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
  var LESS = [213, 94, 0], MORE = [0, 114, 178];
  var dark = window.matchMedia('(prefers-color-scheme: dark)');

  function mix(a, b, share) {
    return a.map(function (c, k) { return Math.round(c + share * (b[k] - c)); });
  }

  // The colour of a share of a scale, 0 to 1; `paper` lies in the middle of two colours.
  function at(scale, share, paper) {
    var place, below;
    if (scale && !scale.diverging) {
      place = Math.max(0, Math.min(1, share)) * (RUN.length - 1);
      below = Math.min(Math.floor(place), RUN.length - 2);
      return mix(RUN[below], RUN[below + 1], place - below);
    }
    place = Math.max(-1, Math.min(1, 2 * share - 1));
    // The strongest of a map with numbers is the pure colour.
    return mix(paper, place < 0 ? LESS : MORE, (scale ? 1 : 0.75) * Math.abs(place));
  }

  function number(v) { return String(Number(v.toPrecision(4))); }

  // A bar of the scale's colours with its numbers.
  function bar(scale, paper) {
    var box = document.createElement('div'), strip = document.createElement('canvas');
    var ctx, k, name = document.createElement('span');
    box.className = 'scale';
    strip.width = 200;
    strip.height = 1;
    ctx = strip.getContext('2d');
    for (k = 0; k < 200; k++) {
      ctx.fillStyle = 'rgb(' + at(scale, k / 199, paper).join(',') + ')';
      ctx.fillRect(k, 0, 1, 1);
    }
    name.textContent = scale.label;
    box.append(number(scale.low), strip, number(scale.high), name);
    return box;
  }

  return { at: at, bar: bar, dark: dark };
}());


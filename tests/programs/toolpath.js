// Length and box of the path of a program, by gcode-toolpath: node toolpath.js FILE
const Toolpath = require('gcode-toolpath');
const Path = Toolpath.default || Toolpath.GCodeToolpath || Toolpath;
let moves = 0, length = 0;
const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
const path = new Path({
  addLine: (modal, from, to) => {
    const [a, b] = [from, to].map((at) => [at.x, at.y, at.z]);
    // The first move comes from wherever the machine stood.
    if (moves++ > 0) length += Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
    b.forEach((value, axis) => {
      low[axis] = Math.min(low[axis], value);
      high[axis] = Math.max(high[axis], value);
    });
  },
  addArcCurve: () => { throw new Error('an arc'); },
});
path.loadFromStringSync(require('fs').readFileSync(process.argv[2], 'utf8'));
console.log(JSON.stringify({ moves, length, low, high }));

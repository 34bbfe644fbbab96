document.querySelectorAll("svg.solid").forEach(svg => {
  const parts = JSON.parse(svg.dataset.solid), paths = svg.querySelectorAll("path");
  let turn = +svg.dataset.turn, rise = +svg.dataset.rise, from = null;
  const draw = () => {
    const [s, c, t, d] = [Math.sin(turn), Math.cos(turn), Math.sin(rise), Math.cos(rise)];
    parts.forEach(({ corners, polygons }, i) => {
      const seen = corners.map(([x, y, z]) => [c * y - s * x, t * (c * x + s * y) - d * z]), sides = ["", ""];
      polygons.forEach(polygon => {
        const area = polygon.reduce((sum, a, k) => {
          const [p, q] = [seen[a], seen[polygon[(k + 1) % polygon.length]]];
          return sum + p[0] * q[1] - p[1] * q[0];
        }, 0);
        sides[area < 0 ? 1 : 0] += "M" + polygon.map(a => seen[a].map(v => v.toFixed(3)).join(" ")).join("L") + "Z";
      });
      paths[2 * i].setAttribute("d", sides[0]);
      paths[2 * i + 1].setAttribute("d", sides[1]);
    });
  };
  svg.addEventListener("pointerdown", e => { from = [e.clientX, e.clientY]; svg.setPointerCapture(e.pointerId); });
  svg.addEventListener("pointermove", e => {
    if (!from) return;
    turn -= (e.clientX - from[0]) / 150;
    rise = Math.max(-1.57, Math.min(1.57, rise + (e.clientY - from[1]) / 150));
    from = [e.clientX, e.clientY];
    draw();
  });
  svg.addEventListener("pointerup", () => { from = null; });
});

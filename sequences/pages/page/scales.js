// Scales map a value to its share of the axis, in [0, 1], and choose the ticks.

// The step of 1, 2 or 5 times a power of ten that gives about `count` steps over `span`.
function niceStep(span, count) {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.999);
}

function linearScale(low, high, count, startsAtZero = false) {
  if (startsAtZero) {
    low = 0;
    const step = niceStep(high > 0 ? high : 1, count);
    high = Math.max(1, Math.ceil(high / step - 1e-9)) * step;
  } else if (low === high) {
    [low, high] = [low - 0.5, high + 0.5];
  }
  const step = niceStep(high - low, count);
  // As many decimal places as the step has, so that 3 * 0.1 is written 0.3.
  const places = Math.max(0, -Math.floor(Math.log10(step)));
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) ticks.push(Number((i * step).toFixed(places)));
  return { share: (v) => (v - low) / (high - low), ticks };
}

// Over a few decades ticks at 1, 2 and 5 times powers of ten, over many at every n-th power.
function logScale(low, high, count) {
  const from = Math.log10(low) - 0.06, to = Math.log10(high) + 0.06;
  const decades = to - from;
  const factors = decades * 3 <= count * 1.5 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / count));
  let ticks = [];
  for (let power = Math.floor(from); power <= Math.ceil(to); power += 1) {
    if (power % every === 0) ticks.push(...factors.map((f) => Number(`${f}e${power}`)));
  }
  const inside = (all) => all.filter((v) => Math.log10(v) >= from && Math.log10(v) <= to);
  // Less than a decade may hold too few of these.
  if (inside(ticks).length < 3) ticks = linearScale(10 ** from, 10 ** to, count).ticks.filter((v) => v > 0);
  return { share: (v) => (Math.log10(v) - from) / decades, ticks: inside(ticks) };
}

function valueScale(axis, values, count) {
  const low = Math.min(...values), high = Math.max(...values);
  return axis.log ? logScale(low, high, count) : linearScale(low, high, count, axis.zero);
}

// Frames stand at equal distances, whatever their numbers are.
function frameScale(frames, count) {
  const places = new Map(frames.map((frame, i) => [frame, i]));
  const every = Math.max(1, Math.ceil(niceStep(frames.length, Math.max(1, count))));
  return {
    share: (frame) => (places.get(frame) + 0.5) / frames.length,
    ticks: frames.filter((_, i) => i % every === 0),
    has: (frame) => places.has(frame),
    at: (share) => frames[Math.max(0, Math.min(frames.length - 1, Math.floor(share * frames.length)))],
  };
}

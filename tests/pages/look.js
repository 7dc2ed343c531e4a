// Contrast of every text that is seen, by computed styles (WCAG 2.2, 1.4.3): [ratio, wanted, text] of each.
const parse = (colour) => {
  const parts = colour.match(/[\d.]+/g).map(Number);
  return parts.length === 3 ? [...parts, 1] : parts;
};
const over = (top, below) => [0, 1, 2].map((k) => top[3] * top[k] + (1 - top[3]) * below[k]).concat(1);
const ground = (element) => {
  const found = [];
  for (let one = element; one; one = one.parentElement) {
    found.push(parse(getComputedStyle(one).backgroundColor));
  }
  const dark = matchMedia("(prefers-color-scheme: dark)").matches && matchMedia("screen").matches;
  const canvas = dark ? [18, 18, 18, 1] : [255, 255, 255, 1];
  return found.reverse().reduce((below, top) => over(top, below), canvas);
};
const luminance = (colour) => {
  const linear = colour.slice(0, 3).map((part) => {
    const share = part / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2];
};
const contrast = (one, other) => {
  const [low, high] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (high + 0.05) / (low + 0.05);
};
const found = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (walker.nextNode()) {
  const text = walker.currentNode.textContent.trim();
  const element = walker.currentNode.parentElement;
  const style = getComputedStyle(element);
  if (!text || element.closest("script, style") || style.visibility === "hidden" || !element.getClientRects().length) {
    continue;
  }
  const below = ground(element);
  found.push([contrast(over(parse(style.color), below), below), text.slice(0, 60)]);
}
return found;

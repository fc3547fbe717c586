// From linear light to the screen. The curves are those of `ajar render` (src/output/tonemap).

export const VERTEX = `#version 300 es
in vec2 corner;
void main() { gl_Position = vec4(corner, 0.0, 1.0); }`;

export const FRAGMENT = `#version 300 es
precision highp float;
uniform sampler2D now, before;
uniform vec2 origin, extent, canvas;   // of the image, and of all, in pixels of the screen
uniform vec3 gain;
uniform int curve, mode;
uniform float wipe;
uniform bool isCode;                   // codes for the screen are in now, not light
uniform vec4 region;                   // left, top, right, bottom, 0 to 1
out vec4 color;

vec3 agxSigmoid(vec3 x) {
  const float xp = 10.0 / 16.5, yp = 0.5, slope = 2.0, toe = 3.0, shoulder = 3.25;
  float low = pow(pow(slope * xp, -toe) * (pow(slope * xp / yp, toe) - 1.0), -1.0 / toe);
  float width = 1.0 - xp, height = 1.0 - yp;
  float high = pow(pow(slope * width, -shoulder) * (pow(slope * width / height, shoulder) - 1.0), -1.0 / shoulder);
  vec3 below = max(slope * (xp - x) / low, 0.0), above = max(slope * (x - xp) / high, 0.0);
  vec3 dark = yp - low * below / pow(1.0 + pow(below, vec3(toe)), vec3(1.0 / toe));
  vec3 bright = yp + high * above / pow(1.0 + pow(above, vec3(shoulder)), vec3(1.0 / shoulder));
  return mix(dark, bright, step(xp, x));
}

vec3 agx(vec3 c) {
  const mat3 inset = mat3(0.84247906, 0.042328242, 0.042375655, 0.0784336, 0.8784686, 0.0784336,
                          0.079223745, 0.07916613, 0.879143);
  const mat3 outset = mat3(1.196879, -0.05289685, -0.052971635, -0.09802088, 1.1519031, -0.09804345,
                           -0.09902974, -0.09896118, 1.1510737);
  vec3 l = clamp((log2(max(inset * c, 1e-10)) + 12.47393) / (4.026069 + 12.47393), 0.0, 1.0);
  return pow(max(outset * agxSigmoid(l), 0.0), vec3(2.2));
}

vec3 aces(vec3 c) {
  const mat3 to = mat3(0.59719, 0.076, 0.0284, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
  const mat3 from = mat3(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
  vec3 v = to * c;
  return from * ((v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.432951) + 0.238081));
}

vec3 neutral(vec3 c) {
  const float f = 0.04, start = 0.8 - f;
  float least = min(c.r, min(c.g, c.b));
  c -= least <= 2.0 * f ? least - least * least / (4.0 * f) : f;
  float peak = max(c.r, max(c.g, c.b));
  if (peak <= start) return c;
  float room = 1.0 - start, shown = 1.0 - room * room / (peak + room - start);
  float keep = 1.0 / (0.15 * (peak - shown) + 1.0);
  return c * shown / peak * keep + shown * (1.0 - keep);
}

// Stops above and below middle grey, from blue over grey to red.
vec3 falseColor(vec3 c) {
  float stops = log2(max(dot(c, vec3(0.2126, 0.7152, 0.0722)), 1e-6) / 0.18);
  const vec3 scale[7] = vec3[](vec3(0.05, 0.0, 0.2), vec3(0.0, 0.15, 0.9), vec3(0.0, 0.6, 0.7), vec3(0.4),
                               vec3(0.2, 0.8, 0.1), vec3(1.0, 0.8, 0.0), vec3(1.0, 0.1, 0.0));
  float at = clamp(stops / 2.0 + 3.0, 0.0, 6.0);
  int low = min(int(at), 5);
  vec3 mixed = mix(scale[low], scale[low + 1], at - float(low));
  return pow(mixed, vec3(2.2));
}

vec3 display(vec3 light) {
  vec3 c = clamp(light * gain, 0.0, 1e9);
  if (curve == 0) c = agx(c);
  else if (curve == 1) c = aces(c);
  else if (curve == 2) c = neutral(c);
  else if (curve == 4) c = falseColor(c);
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

void main() {
  vec2 at = vec2(gl_FragCoord.x, canvas.y - gl_FragCoord.y);
  vec2 uv = (at - origin) / extent;
  if (any(lessThan(uv, vec2(0.0))) || any(greaterThanEqual(uv, vec2(1.0)))) {
    color = vec4(0.078, 0.078, 0.082, 1.0);
    return;
  }
  vec3 a = texture(now, uv).rgb, b = texture(before, uv).rgb;
  bool isBefore = mode == 2 || (mode == 1 && at.x < wipe);
  vec3 light = isBefore ? b : a;
  vec3 shown = display(light);
  if (mode == 3) shown = clamp(abs(display(a) - display(b)) * 4.0, 0.0, 1.0);
  if (isCode) shown = light;
  if (any(isnan(light))) shown = vec3(1.0, 0.0, 1.0);
  bool isOutside = any(lessThan(uv, region.xy)) || any(greaterThan(uv, region.zw));
  color = vec4(isOutside ? shown * 0.55 : shown, 1.0);
}`;

/** GLSL shaders. Every leaf has a column of three texels: colour, offset and emphasis, part. */

const LEAF = /* glsl */ `
uniform highp sampler2D leaves;
uniform int columns;
vec4 leafTexel(int leaf, int row) {
  return texelFetch(leaves, ivec2(leaf % columns, 3 * (leaf / columns) + row), 0);
}
`;

/** The leaf of a vertex: that of its face if BY_FACE is defined, for buffers with three vertices for each face. */
const OWN_LEAF = /* glsl */ `
in vec4 normalAndLeaf;
#ifdef BY_FACE
uniform highp sampler2D faceParts;
uniform int faceColumns;
int ownLeaf() {
  int face = gl_VertexID / 3;
  vec4 bytes = texelFetch(faceParts, ivec2(face % faceColumns, face / faceColumns), 0);
  return int(bytes.r * 255.0 + 0.5) + 256 * int(bytes.g * 255.0 + 0.5);
}
#else
int ownLeaf() { return int(normalAndLeaf.w); }
#endif
`;

const HIDDEN = /* glsl */ `gl_Position = vec4(2.0, 2.0, 2.0, 1.0);`;

const HEAD = /* glsl */ `
precision highp float;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
${LEAF}
`;

export const SURFACE_VERTEX = /* glsl */ `${HEAD}
uniform float veil;
in vec3 position;
${OWN_LEAF}
in float concavity;
out vec3 seenFrom;
out float bent;
out vec3 smoothNormal;
flat out vec3 base;
flat out float emphasis;
void main() {
  int leaf = ownLeaf();
  vec4 color = leafTexel(leaf, 0);
  vec4 moved = leafTexel(leaf, 1);
  vec4 seen = modelViewMatrix * vec4(position + moved.xyz, 1.0);
  seenFrom = seen.xyz;
  bent = concavity;
  smoothNormal = normalMatrix * normalAndLeaf.xyz;
  base = color.rgb;
  emphasis = moved.w;
  gl_Position = projectionMatrix * seen;
  if (veil >= 0.0) gl_Position.z -= 0.0004 * gl_Position.w;
  if (color.a < 0.5) ${HIDDEN}
}
`;

/**
 * The opaque surface, or a veil of it above the original materials if ``veil``, its opacity, is not negative.
 *
 * The normals are those of the vertices, turned to the camera, or of the face if they are zero; the lights are fixed to the
 * camera.
 */
export const SURFACE_FRAGMENT = /* glsl */ `
precision highp float;
uniform float fadeIn;
uniform vec3 sky;
uniform vec4 concaveInk;
uniform bool isBentShown;
uniform float veil;
in vec3 seenFrom;
in float bent;
in vec3 smoothNormal;
flat in vec3 base;
flat in float emphasis;
out vec4 color;
vec3 toLinear(vec3 c) { return pow(c, vec3(2.2)); }
vec3 toScreen(vec3 c) { return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2)); }
void main() {
  vec3 towards = normalize(-seenFrom);
  vec3 flatNormal = normalize(cross(dFdx(seenFrom), dFdy(seenFrom)));
  float length2 = dot(smoothNormal, smoothNormal);
  vec3 n = length2 > 0.0 ? smoothNormal * inversesqrt(length2) : flatNormal;
  n *= sign(dot(n, flatNormal) + 1e-6);
  float key = max(dot(n, normalize(vec3(0.38, 0.72, 0.58))), 0.0);
  float fill = max(dot(n, normalize(vec3(-0.75, 0.1, 0.5))), 0.0);
  float up = 0.5 + 0.5 * n.y;
  float facing = max(dot(n, towards), 0.0);
  float gloss = pow(max(dot(n, normalize(towards + normalize(vec3(0.38, 0.72, 0.58)))), 0.0), 40.0);
  vec3 surface = toLinear(base);
  float grey = dot(surface, vec3(0.2126, 0.7152, 0.0722));
  vec3 quiet = mix(vec3(grey), surface, 0.35) * 0.55 + 0.22 * toLinear(sky);
  surface = mix(surface, quiet, clamp(-emphasis, 0.0, 1.0));
  if (isBentShown) surface = mix(mix(surface, toLinear(sky), 0.55), toLinear(concaveInk.rgb), 0.92 * smoothstep(0.0, 1.0, bent));
  vec3 light = vec3(0.36) + 0.24 * up + 0.50 * key + 0.12 * fill + 0.08 * facing;
  vec3 lit = surface * light + vec3(0.06) * gloss + 0.10 * pow(1.0 - facing, 3.0) * toLinear(sky);
  lit = mix(lit, lit * 1.12 + 0.05, clamp(emphasis, 0.0, 1.0));
  float opacity = veil < 0.0 ? 1.0 : veil;
  if (veil >= 0.0 && isBentShown) opacity = max(opacity, 0.9 * smoothstep(0.0, 1.0, bent));
  if (veil >= 0.0 && emphasis > 0.0) opacity = max(opacity + 0.15, 0.35);
  if (veil >= 0.0 && emphasis < 0.0) opacity = 0.75;
  color = vec4(toScreen(lit), 1.0) * opacity * fadeIn;
}
`;

/** Writes numbers from 1 in three bytes, the lowest first: those of leaves, or of drawn faces if BY_FACE is defined. */
export const PICK_FRAGMENT = /* glsl */ `
precision highp float;
flat in float number;
out vec4 color;
void main() {
  int n = int(number + 0.5);
  color = vec4(float(n & 255), float((n >> 8) & 255), float((n >> 16) & 255), 255.0) / 255.0;
}
`;

export const PICK_VERTEX = /* glsl */ `${HEAD}
in vec3 position;
${OWN_LEAF}
flat out float number;
void main() {
  int leaf = ownLeaf();
#ifdef BY_FACE
  number = float(gl_VertexID / 3) + 1.0;
#else
  number = float(leaf) + 1.0;
#endif
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position + leafTexel(leaf, 1).xyz, 1.0);
  if (leafTexel(leaf, 0).a < 0.5) ${HIDDEN}
}
`;

export const WIRE_VERTEX = /* glsl */ `${HEAD}
in vec3 position;
${OWN_LEAF}
void main() {
  int leaf = ownLeaf();
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position + leafTexel(leaf, 1).xyz, 1.0);
  gl_Position.z -= 0.0004 * gl_Position.w;
  if (leafTexel(leaf, 0).a < 0.5) ${HIDDEN}
}
`;

export const PLAIN_FRAGMENT = /* glsl */ `
precision highp float;
uniform vec4 ink;
out vec4 color;
void main() { color = vec4(ink.rgb * ink.a, ink.a); }
`;

/** Expands a line segment to a thin rectangle that faces the camera; omits lines between leaves of one part. */
export const LINE_VERTEX = /* glsl */ `${HEAD}
uniform vec2 pixels;
uniform float width;
uniform vec4 ink;
uniform vec4 selectedInk;
in vec3 position;
in vec3 from;
in vec3 to;
in vec2 sides;
in float strength;
flat out vec4 stroke;
void main() {
  int own = int(sides.x);
  vec4 moved = leafTexel(own, 1);
  float part = leafTexel(own, 2).x;
  bool isBorder = sides.y < 0.0 || part != leafTexel(int(sides.y), 2).x;
  bool isSelected = leafTexel(own, 2).y > 0.5 && sides.y >= 0.0;
  vec4 a = projectionMatrix * modelViewMatrix * vec4(from + moved.xyz, 1.0);
  vec4 b = projectionMatrix * modelViewMatrix * vec4(to + moved.xyz, 1.0);
  vec2 along = (b.xy / b.w - a.xy / a.w) * pixels;
  along = length(along) > 1e-4 ? normalize(along) : vec2(1.0, 0.0);
  float thick = width * (isSelected ? 1.7 : 1.0);
  vec4 at = position.x < 0.5 ? a : b;
  vec2 aside = vec2(-along.y, along.x) * position.y + along * (position.x * 2.0 - 1.0) * 0.5;
  at.xy += aside * thick / pixels * at.w;
  at.z -= (isSelected ? 0.0016 : 0.0012) * at.w;
  gl_Position = at;
  stroke = isSelected ? selectedInk : vec4(ink.rgb, ink.a * strength);
  if (!isBorder || leafTexel(own, 0).a < 0.5) ${HIDDEN}
}
`;

export const LINE_FRAGMENT = /* glsl */ `
precision highp float;
flat in vec4 stroke;
out vec4 color;
void main() { color = vec4(stroke.rgb * stroke.a, stroke.a); }
`;

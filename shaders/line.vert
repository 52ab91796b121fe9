#version 330 core
// Makes a line segment, four vertices that all know both ends, into a screen-aligned quad of constant width with room
// for round caps: core GL need not draw lines wider than a pixel.
layout(location = 0) in vec3 from_world;
layout(location = 1) in vec4 from_colour;
layout(location = 2) in vec3 to_world;
layout(location = 3) in vec4 to_colour;

uniform mat4 clip_from_world;
uniform vec2 viewport_px;
uniform float width_px;

noperspective out vec2 along_across;  // px, from the segment's start
flat out float length_px;
out vec4 line_colour;

void main() {
  vec4 from = clip_from_world * vec4(from_world, 1.0);
  vec4 to = clip_from_world * vec4(to_world, 1.0);
  // Behind the eye there is no place on the screen: cut at the near plane.
  float from_side = from.z + from.w;
  float to_side = to.z + to.w;
  if (from_side < 0.0 && to_side < 0.0) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    along_across = vec2(0.0);
    length_px = 0.0;
    line_colour = vec4(0.0);
    return;
  }
  if (from_side < 0.0) from = mix(from, to, from_side / (from_side - to_side));
  if (to_side < 0.0) to = mix(to, from, to_side / (to_side - from_side));

  vec2 from_px = from.xy / from.w * 0.5 * viewport_px;
  vec2 to_px = to.xy / to.w * 0.5 * viewport_px;
  vec2 span = to_px - from_px;
  length_px = length(span);
  vec2 direction = length_px > 1e-4 ? span / length_px : vec2(1.0, 0.0);
  vec2 normal = vec2(-direction.y, direction.x);

  bool at_end = (gl_VertexID & 2) != 0;
  float side = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
  float reach = 0.5 * width_px + 1.0;  // a pixel more, for the soft edge
  vec2 shift = normal * side * reach + direction * (at_end ? reach : -reach);
  along_across = vec2(at_end ? length_px + reach : -reach, side * reach);
  vec4 base = at_end ? to : from;
  line_colour = at_end ? to_colour : from_colour;
  gl_Position = vec4(base.xy + shift / (0.5 * viewport_px) * base.w, base.z, base.w);
}

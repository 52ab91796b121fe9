#version 330 core
// A point among very many: as shaders/point.vert, but opaque, its faintness taken from the ground's colour, so that
// points need neither blending nor order.
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 colour;

uniform mat4 clip_from_world;
uniform float size_px;
uniform float reference_depth;  // m: nearer points have full strength
uniform vec4 ground;

flat out vec3 point_colour;

void main() {
  gl_Position = clip_from_world * vec4(position, 1.0);
  gl_PointSize = size_px;
  float fade = clamp(reference_depth / max(gl_Position.w, 1e-6), 0.3, 1.0);
  point_colour = mix(ground.rgb, colour.rgb, colour.a * fade);
}

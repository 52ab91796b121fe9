#version 330 core
// A corner of a picture that stands in the 3-D scene.
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texture_position;

uniform mat4 clip_from_world;

out vec2 uv;

void main() {
  uv = texture_position;
  gl_Position = clip_from_world * vec4(position, 1.0);
}

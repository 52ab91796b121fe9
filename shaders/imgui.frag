#version 330 core
// Text, shapes and pictures of the interface: a texture times a tint, not premultiplied.
in vec2 uv;
in vec4 tint;

uniform sampler2D image;

out vec4 colour;

void main() { colour = tint * texture(image, uv); }

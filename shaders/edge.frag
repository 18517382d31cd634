#version 330 core
in vec3 paint;

uniform float opacity;

out vec4 color;

void main()
{
    color = vec4(paint, opacity);
}

#version 330 core
// A mesh whose positions are scaled to the unit cube.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 color; // of the occluder's planes; the original has none

uniform mat4 view;
uniform mat4 projection;

out vec3 place; // in view space
out vec3 paint;

void main()
{
    vec4 viewed = view * vec4(position, 1.0);
    place = viewed.xyz;
    paint = color;
    gl_Position = projection * viewed;
}

#version 330 core
// An edge of a polygon as a strip of two triangles, as wide on the screen wherever it is.
layout(location = 0) in vec3 begin;
layout(location = 1) in vec3 end;
layout(location = 2) in vec4 color; // alpha: the width, as a fraction of the widest

uniform mat4 view;
uniform mat4 projection;
uniform vec2 pixel;  // in clip space
uniform float width; // of the widest, in pixels

out vec3 paint;

void main()
{
    mat4 seen = projection * view;
    vec4 ends[2] = vec4[2](seen * vec4(begin, 1.0), seen * vec4(end, 1.0));
    vec2 along = ends[1].xy / ends[1].w / pixel - ends[0].xy / ends[0].w / pixel;
    float size = length(along);
    along = size > 0.0 ? along / size : vec2(1.0, 0.0);
    int which = gl_VertexID / 2;
    vec2 across = vec2(-along.y, along.x) * (gl_VertexID % 2 == 0 ? -0.5 : 0.5);
    vec2 beyond = along * (which == 0 ? -0.5 : 0.5);
    vec4 corner = ends[which];
    corner.xy += (across + beyond) * width * color.a * pixel * corner.w;
    // Nearer by a hair, so that an edge wins over the polygons that it bounds, and a wide one over
    // the thin ones that end there.
    corner.z -= (0.0012 + 0.0008 * color.a) * corner.w;
    gl_Position = corner;
    paint = color.rgb;
}

#version 330 core
// Looks along the plane's dominant axis, with the slice as the near plane: every kept face lies
// beyond the slice. Everything is exact but the depth.
layout(location = 0) in uvec3 corner; // in voxels

uniform ivec3 axes;        // u, v and the dominant axis
uniform ivec3 high;        // offset, slopeU, slopeV >> 10: in 1/1024 voxel
uniform ivec3 low;         // their lower 10 bits: in 1/1048576 voxel
uniform float pixelScale;  // of u and v, a power of two
uniform float heightScale; // a power of two

void main()
{
    ivec3 grid = ivec3(corner);
    ivec3 factors = ivec3(1, grid[axes.x], grid[axes.y]);
    // The fine half stays below 2^24, and so does the coarse one wherever the two are alike: exact
    // as floats, with one rounding in their sum, so that its sign is right.
    int coarse = grid[axes.z] * 1024 - high.x * factors.x - high.y * factors.y - high.z * factors.z;
    int fine = low.x * factors.x + low.y * factors.y + low.z * factors.z;
    float height = float(coarse) / 1024.0 - float(fine) / 1048576.0;

    // Next to -1 a float has no room for the smallest heights. Below the plane must stay below it.
    float depth = height * heightScale - 1.0;
    if (height < 0.0) {
        depth = min(depth, -1.0 - 1.0 / 8388608.0);
    }
    gl_Position = vec4(vec2(factors.yz) * pixelScale - 1.0, depth, 1.0);
}

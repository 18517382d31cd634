#version 330 core
// Lights the original, lays the occluder over it, and averages the samples of a pixel.
uniform sampler2D normals; // of the original; alpha is 0 where there is none
uniform sampler2D depths;
uniform sampler2D occluder; // its colours; alpha is how much they hide
uniform sampler2D occluderDepths;
uniform int side;   // samples a pixel along x and along y
uniform vec3 range; // distance of the near and the far plane; 1 when in perspective
uniform vec2 reach; // half of the image: in view space, or at distance 1 when in perspective
uniform vec3 up;    // of the world, in view space

out vec4 color;

const vec3 CLAY = vec3(0.60, 0.56, 0.52);
const int TAPS = 6;
const float RADIUS = 0.22;

float GetDistance(float depth)
{
    float along = range.y - range.x;
    return range.z > 0.5 ? range.x * range.y / (range.y - depth * along) : range.x + depth * along;
}

float GetScale(float distance)
{
    return range.z > 0.5 ? distance : 1.0;
}

vec3 GetPlace(ivec2 at)
{
    vec2 size = vec2(textureSize(depths, 0));
    at = clamp(at, ivec2(0), ivec2(size) - 1);
    float distance = GetDistance(texelFetch(depths, at, 0).r);
    vec2 screen = (vec2(at) + 0.5) / size * 2.0 - 1.0;
    return vec3(screen * reach * GetScale(distance), -distance);
}

vec3 GetNormal(ivec2 at)
{
    return texelFetch(normals, at, 0).xyz * 2.0 - 1.0;
}

// How open the sky is above a place (McGuire et al. 2011, The Alchemy Screen-Space Ambient
// Obscurance Algorithm). Each sample of a pixel turns the spiral of taps further, so that together
// they look everywhere and leave no pattern.
float GetOpenness(ivec2 at, int turn)
{
    vec3 place = GetPlace(at), normal = GetNormal(at);
    vec2 pixels = RADIUS / (reach * GetScale(-place.z)) * 0.5 * vec2(textureSize(depths, 0));
    float closed = 0.0;
    for (int i = 0; i < TAPS; ++i) {
        float tap = float(i) + (float(turn) + 0.5) / float(side * side);
        float angle = 2.399963 * (float(turn) + float(side * side * i));
        vec2 away = sqrt(tap / float(TAPS)) * vec2(cos(angle), sin(angle));
        vec3 there = GetPlace(at + ivec2(pixels * away)) - place;
        closed += max(0.0, dot(there, normal) - 0.004) / (dot(there, there) + 0.003);
    }
    return pow(max(0.0, 1.0 - 0.16 * closed / float(TAPS)), 1.5);
}

// 1 where the distance jumps between a pixel and its neighbours: the lines that one would draw.
float GetOutline(ivec2 at)
{
    float here = -GetPlace(at).z;
    float jump = 0.0;
    for (int i = 0; i < 2; ++i) {
        ivec2 away = i == 0 ? ivec2(side, 0) : ivec2(0, side);
        float before = -GetPlace(at - away).z, behind = -GetPlace(at + away).z;
        jump = max(jump, abs(before + behind - 2.0 * here));
    }
    return smoothstep(0.015, 0.06, jump);
}

vec3 Light(vec3 normal)
{
    const vec3 key = normalize(vec3(-0.5, 0.62, 0.7));
    float sky = 0.5 + 0.5 * dot(normal, up);
    float lit = 0.5 + 0.5 * dot(normal, key);
    float rim = pow(1.0 - clamp(normal.z, 0.0, 1.0), 3.0);
    vec3 ambient = mix(vec3(0.42, 0.39, 0.37), vec3(0.62, 0.66, 0.72), sky);
    return CLAY * (ambient + 0.75 * lit * lit * vec3(1.0, 0.96, 0.90)) + 0.12 * rim;
}

vec3 Encode(vec3 linear)
{
    return mix(12.92 * linear, 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055,
               step(0.0031308, linear));
}

vec3 Decode(vec3 srgb)
{
    return mix(srgb / 12.92, pow((srgb + 0.055) / 1.055, vec3(2.4)), step(0.04045, srgb));
}

void main()
{
    ivec2 corner = ivec2(gl_FragCoord.xy) * side;
    float height = gl_FragCoord.y * float(side) / float(textureSize(depths, 0).y);
    vec3 background = mix(vec3(0.80, 0.81, 0.83), vec3(0.93, 0.935, 0.94), height);

    vec3 sum = vec3(0.0);
    for (int i = 0; i < side * side; ++i) {
        ivec2 at = corner + ivec2(i % side, i / side);
        bool covered = texelFetch(normals, at, 0).a > 0.5;
        vec3 under = background;
        if (covered) {
            under = Light(GetNormal(at)) * GetOpenness(at, i);
        }
        under *= 1.0 - 0.55 * GetOutline(at);
        vec4 over = texelFetch(occluder, at, 0);
        float behind = GetDistance(texelFetch(occluderDepths, at, 0).r) -
                       GetDistance(texelFetch(depths, at, 0).r);
        // What sticks out of the original is solid, so that it can be told from what lies within.
        float outside = covered ? smoothstep(0.0, 0.02, -behind) : 1.0;
        float hides = over.a > 0.0 ? max(over.a, 0.85 * outside) : 0.0;
        sum += mix(under, Decode(over.rgb), hides);
    }
    color = vec4(Encode(sum / float(side * side)), 1.0);
}

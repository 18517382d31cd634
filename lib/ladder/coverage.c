// SPDX-License-Identifier: MIT
// From an error in world units to a distance, and from a distance to a part of the screen.
#include <math.h>
#include <paravent/ladder.h>

static const double PI = 3.14159265358979323846;

pvtScreenOptions pvtDefaultScreenOptions(void)
{
    return (pvtScreenOptions){.pixelError = 1.0, .fieldOfView = 60.0, .height = 1080, .width = 0};
}

// [px] A length of 1 at distance 1 along the view axis.
static double GetFocalLength(const pvtScreenOptions* screen)
{
    return 0.5 * screen->height / tan(screen->fieldOfView * (PI / 360.0));
}

// A blocked ray passes within `error` of a point S of the mesh. With f the focal length, θ the
// ray's angle from the view axis and z the depth of S, the picture of S lies at most
// f × error ÷ (cos θ × z) from the ray's pixel. Over all S in a sphere around the center, and
// from twice its radius on, that is largest for the S nearest to the camera: z = distance − reach
// and θ = 0. From any nearer the stretch towards the screen's edges could exceed it.
double pvtGetErrorDistance(const pvtScreenOptions* screen, double error, double reach)
{
    const double distance = reach + GetFocalLength(screen) * error / screen->pixelError;
    return fmax(distance, 2.0 * reach);
}

double pvtGetScreenCoverage(const pvtScreenOptions* screen, double radius, double distance)
{
    const double width = screen->width > 0 ? screen->width : screen->height * (16.0 / 9.0);
    const double pixels = radius / distance * GetFocalLength(screen);
    return fmin(1.0, PI * pixels * pixels / (width * screen->height));
}

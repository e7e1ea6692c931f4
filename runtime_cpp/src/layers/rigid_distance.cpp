// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Principal contacts are put together (rigid_formation.cpp) from elementary ones: vertex against face, edge across edge, rim, and curved
// surface.  A curved surface that is all points at one distance from a point, segment or circle is met as that skeleton; cones and
// paraboloids by their distance function.  Feasible directions: a face meets a vertex only where no neighbouring vertex lies below
// it; edges cross only where their common normal lies between the two faces beside each (their arcs cross on the Gauss map).
#include "rigid_distance.h"

#include <cmath>

#include "../rotation.h"
#include "../vec.h"

namespace palpate {
namespace {

constexpr double nothing = 1e9;
constexpr double arc_slack = 0.05;  // sine; edges that the tolerance of contact lets lean past a face's normal

// cos and sin of k pi / 8: the runtime calls no trigonometric function.
constexpr double half = 0.70710678118654752, c1 = 0.92387953251128676, s1 = 0.38268343236508977;
constexpr double around[16][2] = {{1, 0}, {c1, s1}, {half, half}, {s1, c1}, {0, 1}, {-s1, c1}, {-half, half}, {-c1, s1},
                                  {-1, 0}, {-c1, -s1}, {-half, -half}, {-s1, -c1}, {0, -1}, {s1, -c1}, {half, -half}, {c1, -s1}};
constexpr double tangent_sixteenth = 0.19891236737965801;  // tan(pi / 16)

struct placed {
    const rigid_element* e;
    const double* numbers;
    const rigid_pose* pose;  // null: the world's axes
    double centre[3], axis[3], across[3];
    std::uint32_t index;
};

void subtract(const double a[3], const double b[3], double c[3]) noexcept {
    for (int i = 0; i < 3; ++i) c[i] = a[i] - b[i];
}

void along(const double p[3], double t, const double d[3], double q[3]) noexcept {
    for (int i = 0; i < 3; ++i) q[i] = p[i] + t * d[i];
}

double norm(const double a[3]) noexcept { return std::sqrt(dot(a, a)); }

void turn(const rigid_pose& pose, const double v[3], double w[3]) noexcept {
    for (int i = 0; i < 3; ++i) w[i] = dot(pose.rotation[i], v);
}

void turn_back(const rigid_pose* pose, const double v[3], double w[3]) noexcept {
    for (int i = 0; i < 3; ++i) {
        w[i] = pose == nullptr ? v[i] : pose->rotation[0][i] * v[0] + pose->rotation[1][i] * v[1] + pose->rotation[2][i] * v[2];
    }
}

void normal_of(const placed& s, int which, double n[3]) noexcept {
    if (s.pose == nullptr) {
        for (int i = 0; i < 3; ++i) n[i] = s.e->normal[which][i];
    } else {
        turn(*s.pose, s.e->normal[which], n);
    }
}

placed place(const palpate_rigid& scene, std::uint32_t i, const rigid_pose* pose) noexcept {
    placed s;
    s.e = &scene.element[i];
    s.numbers = scene.number + s.e->number_first;
    s.pose = pose;
    s.index = i;
    if (pose == nullptr) {
        for (int a = 0; a < 3; ++a) {
            s.centre[a] = s.e->centre[a];
            s.axis[a] = s.e->axis[a];
            s.across[a] = s.e->across[a];
        }
    } else {
        turn(*pose, s.e->centre, s.centre);
        for (int a = 0; a < 3; ++a) s.centre[a] += pose->position[a];
        turn(*pose, s.e->axis, s.axis);
        turn(*pose, s.e->across, s.across);
    }
    return s;
}

// One call's limits, and where its contacts go.
struct search {
    double reach, deepest, slack;
    rigid_touches* found;
};

// Contact of x with y: `n` points out of y, `p` lies on x.  `x_held`: x is the held object's.
void emit(const search& q, const placed& x, const placed& y, bool x_held, const double p[3], const double n[3], double gap) noexcept {
    if (!(gap <= q.reach && gap >= -q.deepest)) return;
    rigid_touches& list = *q.found;
    std::uint32_t slot = list.count;
    if (slot == rigid_touch_limit) {  // the least deep one goes
        list.overflow = 1;
        slot = 0;
        for (std::uint32_t i = 1; i < rigid_touch_limit; ++i) {
            if (list.at[i].gap > list.at[slot].gap) slot = i;
        }
        if (list.at[slot].gap <= gap) return;
    } else {
        ++list.count;
    }
    rigid_touch& t = list.at[slot];
    t.held = x_held ? x.index : y.index;
    t.fixed = x_held ? y.index : x.index;
    t.gap = gap;
    for (int i = 0; i < 3; ++i) {
        t.normal[i] = x_held ? n[i] : -n[i];
        t.point[i] = x_held ? p[i] : p[i] - gap * n[i];
    }
}

// ---- feasible directions: n points out of the other object ----

bool vertex_fits(const search& q, const placed& v, const double n[3]) noexcept {
    double m[3];
    turn_back(v.pose, n, m);
    for (std::uint32_t i = 0; i < v.e->number_count; i += 3) {
        if (dot(v.numbers + i, m) < -q.reach) return false;
    }
    return true;
}

// Whether unit d lies on the arc between unit n0 and n1.
bool between(const double d[3], const double n0[3], const double n1[3]) noexcept {
    const double c = dot(n0, n1) - arc_slack;
    return dot(d, n0) >= c && dot(d, n1) >= c;
}

bool segment_fits(const placed& s, const double n[3]) noexcept {
    const double d[3] = {-n[0], -n[1], -n[2]};
    double n0[3], n1[3];
    normal_of(s, 0, n0);
    normal_of(s, 1, n1);
    return between(d, n0, n1);
}

bool circle_fits(const placed& s, const double radial[3], const double n[3]) noexcept {
    const double d[3] = {-n[0], -n[1], -n[2]};
    const double k = s.e->side * std::sqrt(1.0 - s.e->size * s.e->size);
    double n1[3];
    for (int i = 0; i < 3; ++i) n1[i] = k * radial[i] + s.e->size * s.axis[i];
    const double k0 = s.e->side * std::sqrt(1.0 - s.e->low * s.e->low);
    double n0[3];
    for (int i = 0; i < 3; ++i) n0[i] = k0 * radial[i] + s.e->low * s.axis[i];
    return between(d, n0, n1);
}

bool cap_fits(const placed& s, const double n[3], double sign) noexcept {  // sphere s is met along sign * n
    return s.e->low <= -1.0 || sign * dot(n, s.axis) >= s.e->low - 1e-6;
}

// ---- signed distance of a point to a surface ----

// Whether (x, y) is within the boundary lines, holes left out, or at most `slack` from one.
bool in_polygon(const placed& s, double x, double y, double slack) noexcept {
    bool inside = false;
    for (std::uint32_t i = 0; i < s.e->number_count; i += 4) {
        const double* l = s.numbers + i;
        const double dx = l[2] - l[0], dy = l[3] - l[1], vx = x - l[0], vy = y - l[1];
        const double turn = dx * vy - dy * vx, square = dx * dx + dy * dy, along_it = dx * vx + dy * vy;
        if (turn * turn <= slack * slack * square && along_it >= 0.0 && along_it <= square) return true;
        if ((l[1] > y) != (l[3] > y) && (turn > 0.0) == (dy > 0.0)) inside = !inside;
    }
    return inside;
}

// gap and unit normal (out of the solid) at p; false where the foot is not on the surface.
bool to_surface(const search& q, const placed& s, const double p[3], double& gap, double n[3]) noexcept {
    const rigid_element& e = *s.e;
    double v[3];
    subtract(p, s.centre, v);
    const double z = dot(v, s.axis);
    if (e.kind == rigid_polygon) {
        gap = z;
        for (int i = 0; i < 3; ++i) n[i] = s.axis[i];
        double other[3];
        cross(s.axis, s.across, other);
        return in_polygon(s, dot(v, s.across), dot(v, other), q.slack);
    }
    if (e.kind == rigid_sphere) {
        const double length = norm(v);
        if (length < 1e-12) return false;
        for (int i = 0; i < 3; ++i) n[i] = e.side * v[i] / length;
        gap = e.side * (length - e.radius);
        return cap_fits(s, n, e.side);
    }
    double radial[3];
    along(v, -z, s.axis, radial);
    const double rho = norm(radial);
    if (e.kind == rigid_disc) {
        gap = z;
        for (int i = 0; i < 3; ++i) n[i] = s.axis[i];
        return rho <= e.radius + q.slack && rho >= e.size - q.slack;
    }
    if (rho < 1e-12) {
        for (int i = 0; i < 3; ++i) radial[i] = s.across[i];
    } else {
        for (int i = 0; i < 3; ++i) radial[i] /= rho;
    }
    if (e.kind == rigid_cylinder) {
        for (int i = 0; i < 3; ++i) n[i] = e.side * radial[i];
        gap = e.side * (rho - e.radius);
        return std::fabs(z) <= e.high;
    }
    if (e.kind == rigid_cone) {
        const double sine = e.size * e.cosine;
        for (int i = 0; i < 3; ++i) n[i] = e.side * (e.cosine * radial[i] - sine * s.axis[i]);
        const double d = rho * e.cosine - z * sine;
        gap = e.side * d;
        const double foot = z + d * sine;
        return foot >= e.low && foot <= e.high;
    }
    if (e.kind == rigid_torus) {
        const double out = rho - e.radius, length = std::sqrt(out * out + z * z);
        if (length < 1e-12) return false;
        for (int i = 0; i < 3; ++i) n[i] = (out * radial[i] + z * s.axis[i]) / length;
        gap = length - e.size;
        return true;
    }
    if (e.kind != rigid_paraboloid) return false;
    // Foot of (rho, z) on z = c rho^2: f(r) = 2 c^2 r^3 + (1 - 2 c z) r - rho = 0, by Newton's method from above, where f is convex.
    const double c = e.size, over = z > 0.0 ? std::sqrt(z / c) : 0.0;
    double r = rho > over ? rho : over;
    for (int step = 0; step < 24; ++step) {
        const double f = (2.0 * c * c * r * r + 1.0 - 2.0 * c * z) * r - rho, slope = 6.0 * c * c * r * r + 1.0 - 2.0 * c * z;
        if (!(slope > 1e-12)) break;
        const double move = f / slope;
        r -= move;
        if (std::fabs(move) < 1e-13 * (1.0 + r)) break;
    }
    const double slope = 2.0 * c * r, scale = 1.0 / std::sqrt(1.0 + slope * slope);
    const double d = ((rho - r) * slope - (z - c * r * r)) * scale;  // along the normal out of z > c rho^2
    for (int i = 0; i < 3; ++i) n[i] = e.side * scale * (slope * radial[i] - s.axis[i]);
    gap = e.side * d;
    return c * r * r <= e.high;
}

// ---- smallest values along a segment or a circle ----

template <class Function>
double golden(const Function& f, double a, double b) noexcept {
    constexpr double ratio = 0.61803398874989485;
    double x = b - ratio * (b - a), y = a + ratio * (b - a), fx = f(x), fy = f(y);
    for (int step = 0; step < 30; ++step) {
        if (fx < fy) {
            b = y; y = x; fy = fx; x = b - ratio * (b - a); fx = f(x);
        } else {
            a = x; x = y; fx = fy; y = a + ratio * (b - a); fy = f(y);
        }
    }
    return 0.5 * (a + b);
}

// Calls at(t) for each local minimum of f inside (-length, length), two at most.
template <class Function, class Visit>
void along_segment(double length, const Function& f, const Visit& at) noexcept {
    constexpr int n = 8;
    double value[n + 1];
    for (int i = 0; i <= n; ++i) value[i] = f(length * (2.0 * i / n - 1.0));
    int visits = 0;
    for (int i = 0; i <= n && visits < 2; ++i) {
        if (!(value[i] < nothing) || (i > 0 && value[i - 1] < value[i]) || (i < n && value[i + 1] <= value[i])) continue;
        const double from = length * (2.0 * (i > 0 ? i - 1 : 0) / n - 1.0), to = length * (2.0 * (i < n ? i + 1 : n) / n - 1.0);
        const double t = golden(f, from, to);
        if (std::fabs(t) < length * (1.0 - 1e-6)) {
            at(t);
            ++visits;
        }
    }
}

// Calls at(radial) for the two lowest local minima of f(radial), radial: unit, across the axis of s.
template <class Function, class Visit>
void around_axis(const placed& s, const Function& f, const Visit& at) noexcept {
    double side[3], radial[3], value[16];
    cross(s.axis, s.across, side);
    const auto turned = [&](double c, double sn) {
        for (int i = 0; i < 3; ++i) radial[i] = c * s.across[i] + sn * side[i];
    };
    for (int k = 0; k < 16; ++k) {
        turned(around[k][0], around[k][1]);
        value[k] = f(radial);
    }
    int best[2] = {-1, -1};
    for (int k = 0; k < 16; ++k) {
        if (!(value[k] < nothing) || value[(k + 15) % 16] < value[k] || value[(k + 1) % 16] <= value[k]) continue;
        if (best[0] < 0 || value[k] < value[best[0]]) {
            best[1] = best[0];
            best[0] = k;
        } else if (best[1] < 0 || value[k] < value[best[1]]) {
            best[1] = k;
        }
    }
    for (int b : best) {
        if (b < 0) continue;
        const auto at_tangent = [&](double t) {
            const double w = 1.0 / (1.0 + t * t), c = (1.0 - t * t) * w, sn = 2.0 * t * w;
            turned(around[b][0] * c - around[b][1] * sn, around[b][1] * c + around[b][0] * sn);
        };
        const double t = golden([&](double u) { at_tangent(u); return f(radial); }, -tangent_sixteenth, tangent_sixteenth);
        at_tangent(t);
        at(radial);
    }
}

// Calls at(radial, p) for the two lowest local minima of f(p) on the circle.
template <class Function, class Visit>
void along_circle(const placed& s, const Function& f, const Visit& at) noexcept {
    double p[3];
    const auto there = [&](const double radial[3]) { along(s.centre, s.e->radius, radial, p); };
    around_axis(s, [&](const double radial[3]) { there(radial); return f(p); }, [&](const double radial[3]) { there(radial); at(radial, p); });
}

// ---- pairs ----

// A ball of radius r about p on x against y's surface.
void point_surface(const search& q, const placed& x, const placed& y, bool x_held, const double p[3], double r) noexcept {
    double gap, n[3], on[3];
    if (!to_surface(q, y, p, gap, n)) return;
    if (x.e->kind == rigid_vertex && !vertex_fits(q, x, n)) return;
    if (x.e->kind == rigid_sphere && !cap_fits(x, n, -1.0)) return;
    along(p, -r, n, on);
    emit(q, x, y, x_held, on, n, gap - r);
}

double plain_radius(const placed& s) noexcept { return s.e->kind == rigid_cylinder ? s.e->radius : 0.0; }

// Edges, and the axes of cylinders.
void segment_segment(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    const double rx = plain_radius(x), ry = plain_radius(y);
    double w[3], n[3], p[3], on[3];
    subtract(x.centre, y.centre, w);
    const double b = dot(x.axis, y.axis), d = dot(x.axis, w), e = dot(y.axis, w), square = 1.0 - b * b;
    const double lx = x.e->high, ly = y.e->high;
    const bool edges = rx == 0.0 && ry == 0.0;
    // Parallel where, over their length, they part by less than a tenth of the slack of contact.
    const double shorter = lx < ly ? lx : ly;
    if (square * shorter * shorter < q.reach * q.reach) {
        if (edges) return;  // parallel edges touch in vertices, or as a face and an edge
        const double sign = b > 0.0 ? 1.0 : -1.0, offset = -d;  // y's centre in x's coordinate
        const double from = offset - ly > -lx ? offset - ly : -lx, to = offset + ly < lx ? offset + ly : lx;
        if (!(to - from > q.reach)) return;
        for (int end = 0; end < 2; ++end) {
            const double t = end == 0 ? from : to, u = sign * (t - offset);
            double foot[3];
            along(x.centre, t, x.axis, p);
            along(y.centre, u, y.axis, foot);
            subtract(p, foot, n);
            const double length = norm(n);
            if (length < 1e-12) return;
            for (double& a : n) a /= length;
            if ((x.e->kind == rigid_segment && !segment_fits(x, n))) return;
            const double back[3] = {-n[0], -n[1], -n[2]};
            if (y.e->kind == rigid_segment && !segment_fits(y, back)) return;
            along(p, -rx, n, on);
            emit(q, x, y, x_held, on, n, length - rx - ry);
        }
        return;
    }
    const double t = (b * e - d) / square, u = (e - b * d) / square;
    if (std::fabs(t) > lx + q.slack || std::fabs(u) > ly + q.slack) return;
    double foot[3];
    along(x.centre, t, x.axis, p);
    along(y.centre, u, y.axis, foot);
    double gap;
    if (edges) {
        cross(x.axis, y.axis, n);
        const double length = norm(n);
        for (double& a : n) a /= length;
        double back[3] = {-n[0], -n[1], -n[2]};
        if (!(segment_fits(x, n) && segment_fits(y, back))) {
            for (int i = 0; i < 3; ++i) {
                n[i] = -n[i];
                back[i] = -n[i];
            }
            if (!(segment_fits(x, n) && segment_fits(y, back))) return;
        }
        subtract(p, foot, w);
        gap = dot(w, n);
        along(p, 0.0, n, on);
    } else {
        subtract(p, foot, n);
        const double length = norm(n);
        if (length < 1e-12) return;
        for (double& a : n) a /= length;
        const double back[3] = {-n[0], -n[1], -n[2]};
        if (x.e->kind == rigid_segment && !segment_fits(x, n)) return;
        if (y.e->kind == rigid_segment && !segment_fits(y, back)) return;
        gap = length - rx - ry;
        along(p, -rx, n, on);
    }
    emit(q, x, y, x_held, on, n, gap);
}

// A segment (radius rx) against a surface that is no offset of a segment or circle.
void segment_surface(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    const double rx = plain_radius(x);
    double n[3], p[3];
    const auto gap_at = [&](double t) {
        double gap;
        along(x.centre, t, x.axis, p);
        return to_surface(q, y, p, gap, n) ? gap : nothing;
    };
    along_segment(x.e->high, gap_at, [&](double t) {
        const double gap = gap_at(t);
        if (!(gap < nothing) || (x.e->kind == rigid_segment && !segment_fits(x, n))) return;
        double on[3];
        along(p, -rx, n, on);
        emit(q, x, y, x_held, on, n, gap - rx);
    });
}

double from_circle(const placed& s, const double p[3], double radial[3], double foot[3]) noexcept {
    double v[3];
    subtract(p, s.centre, v);
    const double z = dot(v, s.axis);
    along(v, -z, s.axis, radial);
    const double rho = norm(radial);
    for (int i = 0; i < 3; ++i) radial[i] = rho > 1e-12 ? radial[i] / rho : s.across[i];
    along(s.centre, s.e->radius, radial, foot);
    const double out = rho - s.e->radius;
    return std::sqrt(out * out + z * z);
}

// Two curves without a radius: their common normal, turned so that both bodies allow it.  n points out of y.
template <class Fits>
bool common_normal(const double tangent_x[3], const double tangent_y[3], const Fits& fits, double n[3]) noexcept {
    cross(tangent_x, tangent_y, n);
    const double length = norm(n);
    if (length < 1e-3) return false;
    for (int i = 0; i < 3; ++i) n[i] /= length;
    if (fits(n)) return true;
    for (int i = 0; i < 3; ++i) n[i] = -n[i];
    return fits(n);
}

// An edge or a cylinder's axis (x) against a rim or a torus' circle (y).
void segment_circle(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    const double rx = plain_radius(x), ry = y.e->kind == rigid_torus ? y.e->size : 0.0;
    double p[3], radial[3], foot[3], n[3];
    const auto distance = [&](double t) {
        along(x.centre, t, x.axis, p);
        return from_circle(y, p, radial, foot);
    };
    along_segment(x.e->high, distance, [&](double t) {
        const double length = distance(t);
        double gap = length - rx - ry, on[3];
        if (rx == 0.0 && ry == 0.0) {
            double tangent[3], w[3];
            cross(y.axis, radial, tangent);
            const auto fits = [&](const double m[3]) {
                const double back[3] = {-m[0], -m[1], -m[2]};
                return segment_fits(x, m) && circle_fits(y, radial, back);
            };
            if (!common_normal(x.axis, tangent, fits, n)) return;
            subtract(p, foot, w);
            gap = dot(w, n);
        } else {
            if (length < 1e-12) return;
            for (int i = 0; i < 3; ++i) n[i] = (p[i] - foot[i]) / length;
            const double back[3] = {-n[0], -n[1], -n[2]};
            if (x.e->kind == rigid_segment && !segment_fits(x, n)) return;
            if (y.e->kind == rigid_circle && !circle_fits(y, radial, back)) return;
        }
        along(p, -rx, n, on);
        emit(q, x, y, x_held, on, n, gap);
    });
}

void circle_circle(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    double radial_y[3], foot[3];
    along_circle(x, [&](const double p[3]) { return from_circle(y, p, radial_y, foot); }, [&](const double radial[3], const double p[3]) {
        double tx[3], ty[3], n[3], w[3];
        from_circle(y, p, radial_y, foot);
        cross(x.axis, radial, tx);
        cross(y.axis, radial_y, ty);
        const auto fits = [&](const double m[3]) {
            const double back[3] = {-m[0], -m[1], -m[2]};
            return circle_fits(x, radial, m) && circle_fits(y, radial_y, back);
        };
        if (!common_normal(tx, ty, fits, n)) return;
        subtract(p, foot, w);
        emit(q, x, y, x_held, p, n, dot(w, n));
    });
}

void circle_surface(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    double n[3];
    const auto gap_at = [&](const double p[3]) {
        double gap;
        return to_surface(q, y, p, gap, n) ? gap : nothing;
    };
    along_circle(x, gap_at, [&](const double radial[3], const double p[3]) {
        const double gap = gap_at(p);
        if (gap < nothing && circle_fits(x, radial, n)) emit(q, x, y, x_held, p, n, gap);
    });
}

// A rim, or a torus (tube radius r), over a flat face: its lowest point, or sixteen where all of it is near.
void circle_plane(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    const bool torus = x.e->kind == rigid_torus;
    const double r = torus ? x.e->size : 0.0;
    const double* n = y.axis;
    double down[3], v[3];
    along(n, -dot(n, x.axis), x.axis, down);
    const double tilt = norm(down);
    subtract(x.centre, y.centre, v);
    const double middle = dot(v, n) - r, lowest = middle - x.e->radius * tilt, highest = middle + x.e->radius * tilt;
    if (lowest > q.reach) return;
    const auto one = [&](const double radial[3]) {
        double p[3], on[3], gap, m[3];
        along(x.centre, x.e->radius, radial, p);
        if (!to_surface(q, y, p, gap, m) || (!torus && !circle_fits(x, radial, m))) return;
        along(p, -r, n, on);
        emit(q, x, y, x_held, on, n, gap - r);
    };
    if (highest <= q.reach || tilt < 1e-9) {
        double side[3];
        cross(x.axis, x.across, side);
        for (const auto& a : around) {
            double radial[3];
            for (int i = 0; i < 3; ++i) radial[i] = a[0] * x.across[i] + a[1] * side[i];
            one(radial);
        }
    } else {
        for (double& a : down) a /= -tilt;
        one(down);
    }
}

// A solid paraboloid (y) over a flat face (x): where its normal is the face's, turned round.
void plane_paraboloid(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    if (y.e->side < 0) return;
    const double nz = dot(x.axis, y.axis);
    if (!(nz > 1e-6)) return;  // out of the paraboloid is down
    const double c = y.e->size;
    double flat[3], p[3];
    along(x.axis, -nz, y.axis, flat);
    const double k = -1.0 / (2.0 * c * nz), rho2 = k * k * dot(flat, flat);
    if (c * rho2 > y.e->high) return;
    along(y.centre, k, flat, p);
    along(p, c * rho2, y.axis, p);
    double gap, m[3];
    if (to_surface(q, x, p, gap, m)) emit(q, y, x, !x_held, p, m, gap);
}

// A torus (x) against any surface (y): its circle against that surface, offset by the tube's radius.
void torus_surface(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    double n[3];
    const auto gap_at = [&](const double p[3]) {
        double gap;
        return to_surface(q, y, p, gap, n) ? gap : nothing;
    };
    along_circle(x, gap_at, [&](const double radial[3], const double p[3]) {
        const double gap = gap_at(p);
        double on[3], tangent[3];
        cross(x.axis, radial, tangent);
        if (!(gap < nothing) || std::fabs(dot(n, tangent)) > 1e-3) return;  // the search ended at that surface's rim
        along(p, -x.e->size, n, on);
        emit(q, x, y, x_held, on, n, gap - x.e->size);
    });
}

void cone_normal(const placed& s, const double radial[3], double n[3]) noexcept {
    for (int i = 0; i < 3; ++i) n[i] = s.e->cosine * radial[i] - s.e->size * s.e->cosine * s.axis[i];
}

// A cone (x) against a solid paraboloid (y).  Tangent planes of the cone are one family, each with one parallel plane of the paraboloid: the
// two planes are farthest apart where the paraboloid's point lies over the plane's own generator.
void cone_paraboloid(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    double n[3], b[3];
    const auto facing = [&](const double radial[3]) {  // b: where y's normal is -n
        cone_normal(x, radial, n);
        const double nz = dot(n, y.axis), c = y.e->size;
        if (!(nz > 1e-6)) return false;
        double flat[3];
        along(n, -nz, y.axis, flat);
        const double k = -1.0 / (2.0 * c * nz), height = c * k * k * dot(flat, flat);
        if (height > y.e->high) return false;
        along(y.centre, k, flat, b);
        along(b, height, y.axis, b);
        return true;
    };
    const auto apart = [&](const double radial[3]) {
        if (!facing(radial)) return nothing;
        double w[3];
        subtract(b, x.centre, w);
        return -dot(w, n);
    };
    around_axis(x, apart, [&](const double radial[3]) {
        const double gap = -apart(radial);
        if (!(gap > -nothing)) return;
        double foot[3];
        subtract(b, x.centre, foot);
        along(foot, -gap, n, foot);
        const double height = dot(foot, x.axis), slant = height / x.e->cosine;
        double off[3];  // from the plane's own generator: not zero where the search ended at a rim
        for (int i = 0; i < 3; ++i) {
            const double g = x.e->cosine * x.axis[i] + x.e->size * x.e->cosine * radial[i];
            off[i] = foot[i] - slant * g;
        }
        if (height >= x.e->low && height <= x.e->high && norm(off) < q.slack) emit(q, y, x, !x_held, b, n, gap);
    });
}

// Two solid paraboloids: the point of x nearest to y, by Newton's method on its two coordinates.
void paraboloid_paraboloid(const search& q, const placed& x, const placed& y, bool x_held) noexcept {
    const double c = x.e->size, rim = std::sqrt(x.e->high / c), h = 1e-4 * rim;
    double side[3], p[3], n[3];
    cross(x.axis, x.across, side);
    const auto gap_at = [&](double u, double v) {
        along(x.centre, u, x.across, p);
        along(p, v, side, p);
        along(p, c * (u * u + v * v), x.axis, p);
        double gap;
        return to_surface(q, y, p, gap, n) ? gap : nothing;
    };
    double best[2] = {0.0, 0.0}, least = gap_at(0.0, 0.0);
    for (int ring = 1; ring <= 3; ++ring) {
        for (int k = 0; k < 16; k += 2) {
            const double u = 0.3 * ring * rim * around[k][0], v = 0.3 * ring * rim * around[k][1], gap = gap_at(u, v);
            if (gap < least) {
                least = gap;
                best[0] = u;
                best[1] = v;
            }
        }
    }
    if (!(least < nothing)) return;
    double steepest = 1.0;
    for (int step = 0; step < 12; ++step) {
        const double u = best[0], v = best[1], f = gap_at(u, v);
        const double r = gap_at(u + h, v), l = gap_at(u - h, v), t = gap_at(u, v + h), b = gap_at(u, v - h), rt = gap_at(u + h, v + h);
        if (!(r < nothing && l < nothing && t < nothing && b < nothing && rt < nothing)) return;
        const double gu = (r - l) / (2.0 * h), gv = (t - b) / (2.0 * h);
        const double uu = (r - 2.0 * f + l) / (h * h), vv = (t - 2.0 * f + b) / (h * h), uv = (rt - r - t + f) / (h * h);
        steepest = std::sqrt(gu * gu + gv * gv);
        const double det = uu * vv - uv * uv;
        if (steepest < 1e-7 || !(det > 1e-9) || !(uu > 0.0)) break;
        double du = (uv * gv - vv * gu) / det, dv = (uv * gu - uu * gv) / det;
        const double far = std::sqrt(du * du + dv * dv), longest = 0.25 * rim;
        if (far > longest) {
            du *= longest / far;
            dv *= longest / far;
        }
        best[0] += du;
        best[1] += dv;
    }
    if (steepest > 1e-4 || best[0] * best[0] + best[1] * best[1] > rim * rim) return;
    const double gap = gap_at(best[0], best[1]);
    if (gap < nothing) emit(q, x, y, x_held, p, n, gap);
}

void touch_pair(const search& q, const placed& a, const placed& b) noexcept {
    const bool a_held = true, first = a.e->kind <= b.e->kind;
    const placed &x = first ? a : b, &y = first ? b : a;
    const bool x_held = first ? a_held : !a_held;
    const std::uint32_t ky = y.e->kind;
    switch (x.e->kind) {
        case rigid_vertex:
            if (ky >= rigid_polygon) point_surface(q, x, y, x_held, x.centre, 0.0);
            break;
        case rigid_segment:
            if (ky == rigid_segment || (ky == rigid_cylinder && y.e->side > 0)) segment_segment(q, x, y, x_held);
            else if (ky == rigid_circle || ky == rigid_torus) segment_circle(q, x, y, x_held);
            else if (y.e->side > 0 && (ky == rigid_sphere || ky == rigid_cone || ky == rigid_paraboloid)) segment_surface(q, x, y, x_held);
            break;
        case rigid_circle:
            if (ky == rigid_circle) circle_circle(q, x, y, x_held);
            else if (ky == rigid_polygon || ky == rigid_disc) circle_plane(q, x, y, x_held);
            else circle_surface(q, x, y, x_held);
            break;
        case rigid_polygon:
        case rigid_disc:
            if (ky == rigid_sphere && y.e->side > 0) point_surface(q, y, x, !x_held, y.centre, y.e->radius);
            else if (ky == rigid_torus) circle_plane(q, y, x, !x_held);
            else if (ky == rigid_paraboloid) plane_paraboloid(q, x, y, x_held);
            break;
        case rigid_sphere:
            if (x.e->side > 0) point_surface(q, x, y, x_held, x.centre, x.e->radius);
            else if (ky == rigid_torus) torus_surface(q, y, x, !x_held);
            else if (ky == rigid_sphere && y.e->side > 0) point_surface(q, y, x, !x_held, y.centre, y.e->radius);
            break;
        case rigid_cylinder:
            if (x.e->side < 0) {
                if (ky == rigid_torus) torus_surface(q, y, x, !x_held);
                break;
            }
            if (ky == rigid_cylinder && y.e->side > 0) segment_segment(q, x, y, x_held);
            else if (ky == rigid_torus) segment_circle(q, x, y, x_held);
            else if (y.e->side > 0 && (ky == rigid_cone || ky == rigid_paraboloid)) segment_surface(q, x, y, x_held);
            break;
        case rigid_cone:
            if (ky == rigid_torus) torus_surface(q, y, x, !x_held);
            else if (x.e->side < 0 || y.e->side < 0) break;  // rims meet first
            else if (ky == rigid_paraboloid) cone_paraboloid(q, x, y, x_held);
            break;
        case rigid_torus: torus_surface(q, x, y, x_held); break;
        case rigid_paraboloid:
            if (x.e->side > 0 && y.e->side > 0) paraboloid_paraboloid(q, x, y, x_held);
            break;
        default: break;
    }
}

bool beside(const palpate_rigid& scene, std::uint32_t face, std::uint32_t other) noexcept {
    const rigid_element& e = scene.element[face];
    for (std::uint32_t i = 0; i < e.beside_count; ++i) {
        if (scene.index[e.beside_first + i] == other) return true;
    }
    return false;
}

// A point that is under two faces of a convex edge meets the one that it is least deep under.
void keep_least_deep(const palpate_rigid& scene, rigid_touches& found) noexcept {
    std::uint64_t dropped = 0;
    for (std::uint32_t i = 0; i < found.count; ++i) {
        const rigid_touch& t = found.at[i];
        for (std::uint32_t j = 0; j < found.count; ++j) {
            const rigid_touch& o = found.at[j];
            if (o.gap <= t.gap) continue;
            if ((o.held == t.held && beside(scene, t.fixed, o.fixed)) || (o.fixed == t.fixed && beside(scene, t.held, o.held))) {
                dropped |= std::uint64_t{1} << i;
                break;
            }
        }
    }
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < found.count; ++i) {
        if ((dropped >> i & 1u) == 0) found.at[kept++] = found.at[i];
    }
    found.count = kept;
}

}  // namespace

void rigid_find_touches(const palpate_rigid& scene, const rigid_pose& pose, double reach, double deepest, rigid_touches& found) noexcept {
    found.count = found.overflow = 0;
    const search q{reach, deepest, 0.1 * scene.head.threshold, &found};
    std::uint32_t last = rigid_element_limit;
    placed a{};
    double bound[3] = {0.0, 0.0, 0.0}, radius = 0.0;
    bool have = false;
    for (std::uint32_t i = 0; i < scene.head.pair_count; ++i) {
        const rigid_pair& pair = scene.pair[i];
        if (pair.held != last) {
            last = pair.held;
            have = false;
            turn(pose, scene.element[last].bound_centre, bound);
            for (int k = 0; k < 3; ++k) bound[k] += pose.position[k];
            radius = scene.element[last].bound_radius + reach + deepest;
        }
        const rigid_element& other = scene.element[pair.fixed];
        double v[3];
        subtract(bound, other.bound_centre, v);
        const double far = radius + other.bound_radius;
        if (dot(v, v) > far * far) continue;
        if (!have) {
            a = place(scene, last, &pose);
            have = true;
        }
        touch_pair(q, a, place(scene, pair.fixed, nullptr));
    }
    keep_least_deep(scene, found);
}

}  // namespace palpate

// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
#include "rigid_formation.h"

#include <cmath>

#include "../rotation.h"
#include "../vec.h"

namespace palpate {
namespace {

constexpr std::uint32_t candidate_limit = 192;

struct candidate {
    std::uint32_t key, region;
    std::uint64_t members;  // bit i: touch i
};

std::uint32_t merge_region(const palpate_rigid& scene, std::uint32_t key) noexcept {
    std::uint32_t low = 0, high = scene.head.merge_count;
    while (low < high) {
        const std::uint32_t middle = (low + high) / 2;
        if (scene.merge[middle].key < key) low = middle + 1; else high = middle;
    }
    return low < scene.head.merge_count && scene.merge[low].key == key ? scene.merge[low].region : 0u;
}

bool among(const rigid_keys& keys, std::uint32_t key) noexcept {
    for (std::uint32_t i = 0; i < keys.count; ++i) {
        if (keys.key[i] == key) return true;
    }
    return false;
}

double square_apart(const double a[3], const double b[3]) noexcept {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return dot(d, d);
}

std::uint32_t bits(std::uint64_t m) noexcept {
    std::uint32_t n = 0;
    for (; m != 0; m &= m - 1) ++n;
    return n;
}

// How far the members spread: along their longest chord, and off it, m.
void spread(const rigid_touches& touches, std::uint64_t members, double& length, double& width) noexcept {
    std::uint32_t list[rigid_touch_limit] = {}, n = 0;
    for (std::uint32_t i = 0; i < touches.count; ++i) {
        if ((members >> i & 1u) != 0) list[n++] = i;
    }
    // The chord from the point farthest from the first: long enough to tell a region's kind.
    std::uint32_t a = list[0], b = list[0];
    for (int pass = 0; pass < 2; ++pass) {
        double best = -1.0;
        const std::uint32_t from = pass == 0 ? list[0] : a;
        for (std::uint32_t i = 0; i < n; ++i) {
            const double d = square_apart(touches.at[from].point, touches.at[list[i]].point);
            if (d > best) {
                best = d;
                (pass == 0 ? a : b) = list[i];
            }
        }
    }
    length = std::sqrt(square_apart(touches.at[a].point, touches.at[b].point));
    width = 0.0;
    if (!(length > 0.0)) return;
    double along[3], off[3], c[3];
    for (int k = 0; k < 3; ++k) along[k] = (touches.at[b].point[k] - touches.at[a].point[k]) / length;
    for (std::uint32_t i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) off[k] = touches.at[list[i]].point[k] - touches.at[a].point[k];
        cross(along, off, c);
        const double d = std::sqrt(dot(c, c));
        if (d > width) width = d;
    }
}

double side(const double o[2], const double a[2], const double b[2]) noexcept {
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

struct spot {
    double x[2];
    double pressure;  // m; eps - gap
};

// Convex hull, counter-clockwise (Andrew's monotone chain); `n` spots, at most rigid_touch_limit.
std::uint32_t hull_of(spot* s, std::uint32_t n, spot* hull) noexcept {
    for (std::uint32_t i = 1; i < n; ++i) {
        const spot moved = s[i];
        std::uint32_t j = i;
        for (; j > 0 && (s[j - 1].x[0] > moved.x[0] || (s[j - 1].x[0] == moved.x[0] && s[j - 1].x[1] > moved.x[1])); --j) s[j] = s[j - 1];
        s[j] = moved;
    }
    std::uint32_t count = 0;
    for (int pass = 0; pass < 2; ++pass) {
        const std::uint32_t start = count;
        for (std::uint32_t k = 0; k < n; ++k) {
            const spot& p = s[pass == 0 ? k : n - 1 - k];
            while (count >= start + 2 && side(hull[count - 2].x, hull[count - 1].x, p.x) <= 1e-14) --count;
            hull[count++] = p;
        }
        --count;  // the last is the other chain's first
    }
    return count;
}

// Fills region, point, hull and gyration from the members.
void shape(const palpate_rigid& scene, const rigid_touches& touches, std::uint64_t members, rigid_principal& pc) noexcept {
    const double eps = scene.head.threshold;
    double n[3] = {0.0, 0.0, 0.0}, first[3] = {0.0, 0.0, 0.0};
    pc.gap = 1e9;
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < touches.count; ++i) {
        if ((members >> i & 1u) == 0) continue;
        const rigid_touch& t = touches.at[i];
        for (int k = 0; k < 3; ++k) n[k] += t.normal[k];
        if (count++ == 0) {
            for (int k = 0; k < 3; ++k) first[k] = t.point[k];
        }
        if (t.gap < pc.gap) pc.gap = t.gap;
    }
    const double length = std::sqrt(dot(n, n));
    for (int k = 0; k < 3; ++k) pc.normal[k] = n[k] / (length > 1e-12 ? length : 1.0);
    // Task frame: x along the world axis that is least along the normal, projected.
    int least = 0;
    for (int k = 1; k < 3; ++k) {
        if (std::fabs(pc.normal[k]) < std::fabs(pc.normal[least])) least = k;
    }
    for (int k = 0; k < 3; ++k) pc.tangent[k] = (k == least ? 1.0 : 0.0) - pc.normal[least] * pc.normal[k];
    const double scale = std::sqrt(dot(pc.tangent, pc.tangent));
    for (double& a : pc.tangent) a /= scale > 1e-12 ? scale : 1.0;
    cross(pc.tangent, pc.normal, pc.across);
    pc.hull_count = 0;
    pc.gyration = 0.0;
    for (int k = 0; k < 3; ++k) pc.point[k] = first[k];
    if (pc.region == PALPATE_RIGID_POINT) return;
    spot spots[rigid_touch_limit], hull[2 * rigid_touch_limit];
    std::uint32_t s = 0;
    double height = 0.0;
    for (std::uint32_t i = 0; i < touches.count; ++i) {
        if ((members >> i & 1u) == 0) continue;
        const rigid_touch& t = touches.at[i];
        double v[3];
        for (int k = 0; k < 3; ++k) v[k] = t.point[k] - first[k];
        const double p = eps - t.gap;
        // tangent, across, normal is left-handed: (across, tangent) turns counter-clockwise about the normal
        spots[s++] = {{dot(v, pc.across), dot(v, pc.tangent)}, p > 1e-3 * eps ? p : 1e-3 * eps};
        height += dot(v, pc.normal);
    }
    height /= s;
    double centre[2] = {0.0, 0.0};
    std::uint32_t corners = 0;
    if (pc.region == PALPATE_RIGID_LINE) {
        std::uint32_t a = 0, b = 0;
        for (int pass = 0; pass < 2; ++pass) {
            double best = -1.0;
            const std::uint32_t from = pass == 0 ? 0 : a;
            for (std::uint32_t i = 0; i < s; ++i) {
                const double dx = spots[i].x[0] - spots[from].x[0], dy = spots[i].x[1] - spots[from].x[1], d = dx * dx + dy * dy;
                if (d > best) {
                    best = d;
                    (pass == 0 ? a : b) = i;
                }
            }
        }
        hull[0] = spots[a];
        hull[1] = spots[b];
        corners = 2;
        const double pa = hull[0].pressure, pb = hull[1].pressure, wa = (2.0 * pa + pb) / (3.0 * (pa + pb));
        for (int k = 0; k < 2; ++k) centre[k] = wa * hull[0].x[k] + (1.0 - wa) * hull[1].x[k];
    } else {
        corners = hull_of(spots, s, hull);
        double total = 0.0;
        for (std::uint32_t i = 1; i + 1 < corners; ++i) {
            const double area = side(hull[0].x, hull[i].x, hull[i + 1].x);
            const double sum = hull[0].pressure + hull[i].pressure + hull[i + 1].pressure;
            total += area * sum / 3.0;
            for (int k = 0; k < 2; ++k) {
                centre[k] += area / 12.0 * (hull[0].x[k] * (sum + hull[0].pressure) + hull[i].x[k] * (sum + hull[i].pressure) +
                                            hull[i + 1].x[k] * (sum + hull[i + 1].pressure));
            }
        }
        for (double& c : centre) c /= total > 0.0 ? total : 1.0;
    }
    for (int k = 0; k < 3; ++k) pc.point[k] = first[k] + centre[0] * pc.across[k] + centre[1] * pc.tangent[k] + height * pc.normal[k];
    const std::uint32_t step = (corners + rigid_hull_limit - 1) / rigid_hull_limit;
    for (std::uint32_t i = 0; i < corners; i += step) {
        pc.hull[pc.hull_count][0] = hull[i].x[0] - centre[0];
        pc.hull[pc.hull_count++][1] = hull[i].x[1] - centre[1];
    }
    // Mean distance from the centre: of a line by length, of a plane by triangles about the centre, corners and middle of their rims.
    double weight = 0.0;
    for (std::uint32_t i = 0; i < pc.hull_count; ++i) {
        const double *a = pc.hull[i], *b = pc.hull[(i + 1) % pc.hull_count];
        const double la = std::sqrt(a[0] * a[0] + a[1] * a[1]);
        if (pc.region == PALPATE_RIGID_LINE) {
            pc.gyration += la * la / 2.0;
            weight += la;
        } else {
            const double lb = std::sqrt(b[0] * b[0] + b[1] * b[1]);
            const double mx = 0.5 * (a[0] + b[0]), my = 0.5 * (a[1] + b[1]), lm = std::sqrt(mx * mx + my * my);
            const double area = 0.5 * std::fabs(a[0] * b[1] - a[1] * b[0]);
            pc.gyration += area * 2.0 / 3.0 * (la + 4.0 * lm + lb) / 6.0;
            weight += area;
        }
    }
    if (weight > 0.0) pc.gyration /= weight;
}

// Principal contacts of the touches within `limit` (m), and of those of `last` whatever their gap.
void gather_within(const palpate_rigid& scene, const rigid_touches& touches, const rigid_keys& last, double limit, rigid_contacts& found) noexcept {
    const double eps = scene.head.threshold;
    found.count = 0;
    found.overflow = touches.overflow;
    candidate list[candidate_limit];
    std::uint32_t listed = 0;
    std::uint64_t near = 0;
    for (std::uint32_t i = 0; i < touches.count; ++i) {
        if (touches.at[i].gap <= limit) near |= std::uint64_t{1} << i;
    }
    for (std::uint32_t i = 0; i < touches.count; ++i) {
        const rigid_element &h = scene.element[touches.at[i].held], &f = scene.element[touches.at[i].fixed];
        for (std::uint32_t a = 0; a < h.up_count; ++a) {
            for (std::uint32_t b = 0; b < f.up_count; ++b) {
                const std::uint32_t key = scene.index[h.up_first + a] << 16 | scene.index[f.up_first + b];
                std::uint32_t c = 0;
                while (c < listed && list[c].key != key) ++c;
                if (c == listed) {
                    if (listed == candidate_limit) {
                        found.overflow = 1;
                        continue;
                    }
                    list[listed++] = {key, merge_region(scene, key), 0};
                }
                list[c].members |= std::uint64_t{1} << i;
            }
        }
    }
    // Planes with most members first, then lines; what is left are points.
    std::uint64_t covered = 0;
    for (std::uint32_t region = 2; region >= 1; --region) {
        for (;;) {
            std::uint32_t best = candidate_limit, most = 0;
            std::uint64_t best_members = 0;
            for (std::uint32_t c = 0; c < listed; ++c) {
                if (list[c].region != region) continue;
                const std::uint64_t members = list[c].members & ~covered & (among(last, list[c].key) ? ~std::uint64_t{0} : near);
                const std::uint32_t n = bits(members);
                if (n < region + 1 || n <= most) continue;
                double length, width;
                spread(touches, members, length, width);
                if (length < 2.0 * eps || (region == 2 && width < 2.0 * eps)) continue;
                best = c;
                most = n;
                best_members = members;
            }
            if (best == candidate_limit) break;
            covered |= best_members;
            list[best].region = 0;
            if (found.count == rigid_contact_limit) {
                found.overflow = 1;
                continue;
            }
            rigid_principal& pc = found.at[found.count++];
            pc.key = list[best].key;
            pc.region = region;
            shape(scene, touches, best_members, pc);
            // What else touches at the same place along the same normal belongs to this contact.
            for (std::uint32_t i = 0; i < touches.count; ++i) {
                for (std::uint32_t j = 0; j < touches.count && (covered >> i & 1u) == 0; ++j) {
                    if ((best_members >> j & 1u) != 0 && square_apart(touches.at[i].point, touches.at[j].point) < eps * eps &&
                        dot(touches.at[i].normal, pc.normal) > 0.95) {
                        covered |= std::uint64_t{1} << i;
                    }
                }
            }
        }
    }
    for (;;) {
        std::uint32_t best = rigid_touch_limit;
        for (std::uint32_t i = 0; i < touches.count; ++i) {
            const rigid_touch& t = touches.at[i];
            if ((covered >> i & 1u) != 0 || ((near >> i & 1u) == 0 && !among(last, t.held << 16 | t.fixed))) continue;
            if (best == rigid_touch_limit || t.gap < touches.at[best].gap) best = i;
        }
        if (best == rigid_touch_limit) break;
        const rigid_touch& t = touches.at[best];
        for (std::uint32_t i = 0; i < touches.count; ++i) {
            if (square_apart(touches.at[i].point, t.point) < eps * eps && dot(touches.at[i].normal, t.normal) > 0.95) {
                covered |= std::uint64_t{1} << i;
            }
        }
        covered |= std::uint64_t{1} << best;
        if (found.count == rigid_contact_limit) {
            found.overflow = 1;
            continue;
        }
        rigid_principal& pc = found.at[found.count++];
        pc.key = t.held << 16 | t.fixed;
        pc.region = PALPATE_RIGID_POINT;
        shape(scene, touches, std::uint64_t{1} << best, pc);
    }
}

}  // namespace

void rigid_gather(const palpate_rigid& scene, const rigid_touches& touches, const rigid_keys& last, rigid_contacts& found) noexcept {
    constexpr std::uint32_t none = 0xffffffffu;
    gather_within(scene, touches, last, scene.head.threshold, found);
    if (found.count == 0 || scene.head.formation_count == 0 || rigid_formation_index(scene, found) != none) return;
    // No pose has these contacts and no others: those that are there as well may be out of reach by a digital error.
    rigid_contacts wider;
    gather_within(scene, touches, last, rigid_reach(scene.head), wider);
    if (rigid_formation_index(scene, wider) != none) found = wider;
}

std::uint32_t rigid_formation_index(const palpate_rigid& scene, const rigid_contacts& contacts) noexcept {
    constexpr std::uint32_t none = 0xffffffffu;
    if (contacts.count == 0 || scene.head.formation_count == 0) return none;
    std::uint32_t key[rigid_contact_limit];
    for (std::uint32_t i = 0; i < contacts.count; ++i) {
        std::uint32_t j = i;
        for (; j > 0 && key[j - 1] > contacts.at[i].key; --j) key[j] = key[j - 1];
        key[j] = contacts.at[i].key;
    }
    std::uint64_t hash = 0xcbf29ce484222325u;  // FNV-1a over the keys as words
    for (std::uint32_t i = 0; i < contacts.count; ++i) hash = (hash ^ key[i]) * 0x100000001b3u;
    std::uint32_t low = 0, high = scene.head.formation_count;
    while (low < high) {
        const std::uint32_t middle = (low + high) / 2;
        if (scene.formation[middle].hash < hash) low = middle + 1; else high = middle;
    }
    for (; low < scene.head.formation_count && scene.formation[low].hash == hash; ++low) {
        const rigid_formation& f = scene.formation[low];
        bool same = f.count == contacts.count;
        for (std::uint32_t i = 0; i < contacts.count && same; ++i) same = scene.formation_index[f.first + i] == key[i];
        if (same) return low;
    }
    return none;
}

}  // namespace palpate

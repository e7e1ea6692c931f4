// SPDX-FileCopyrightText: 2026 The palpate authors
// SPDX-License-Identifier: Apache-2.0
// Proves cooked rigid objects: after this no tick reads outside them or divides by zero.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>

#include "../crc32.h"
#include "rigid_scene.h"

namespace palpate {
namespace {

struct answer {
    char* text;
    std::size_t size;
    palpate_status status;
};

bool refuse(answer& why, palpate_status status, const char* sentence) noexcept {
    why.status = status;
    if (why.text != nullptr && why.size > 0) std::snprintf(why.text, why.size, "%s", sentence);
    return false;
}

bool number_fits(double x, double low, double high) noexcept { return x >= low && x <= high; }  // false for NaN

bool vector_fits(const double x[3], double limit) noexcept {
    return number_fits(x[0], -limit, limit) && number_fits(x[1], -limit, limit) && number_fits(x[2], -limit, limit);
}

bool unit(const double x[3]) noexcept {
    const double square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    return number_fits(square, 1.0 - 1e-6, 1.0 + 1e-6);
}

bool section(std::uint64_t offset, std::uint64_t count, std::size_t each, std::uint64_t size) noexcept {
    return offset % 64 == 0 && offset >= sizeof(rigid_header) && offset <= size && count <= rigid_pool_limit &&
           count * each <= size - offset;
}

bool check_header(const rigid_header& h, std::uint64_t size, answer& why) noexcept {
    if (h.held_count == 0 || h.element_count <= h.held_count || h.element_count > rigid_element_limit ||
        h.pair_count > rigid_pair_limit) {
        return refuse(why, PALPATE_BAD_LAYOUT, "The counts of elements and pairs are wrong: cook again.");
    }
    if (!section(h.elements, h.element_count, sizeof(rigid_element), size) || !section(h.pairs, h.pair_count, sizeof(rigid_pair), size) ||
        !section(h.numbers, h.number_count, sizeof(double), size) || !section(h.indices, h.index_count, sizeof(std::uint32_t), size) ||
        !section(h.merges, h.merge_count, sizeof(rigid_merge), size) ||
        !section(h.formations, h.formation_count, sizeof(rigid_formation), size) ||
        !section(h.formation_indices, h.formation_index_count, sizeof(std::uint32_t), size)) {
        return refuse(why, PALPATE_BAD_LAYOUT, "A section lies outside the bytes: cook again.");
    }
    if (!number_fits(h.threshold, 1e-7, 0.1) || !number_fits(h.stiffness, 1e-3, 1e7) || !number_fits(h.damping, 0.0, 1e5) ||
        !number_fits(h.static_friction, 0.0, 10.0) || !number_fits(h.kinetic_friction, 0.0, h.static_friction) ||
        !number_fits(h.tangential_stiffness, 1e-3, 1e7) || !number_fits(h.depth_max, h.threshold, 0.1) ||
        !number_fits(h.speed_static, 1e-9, 10.0) || !number_fits(h.hysteresis, 0.0, 1.0) || !vector_fits(h.gravity, 1e3) ||
        !number_fits(h.mass, 1e-9, 1e4) || !number_fits(h.held_radius, 1e-9, 1e2)) {
        return refuse(why, PALPATE_NOT_FINITE, "A parameter of contact or mass is outside its range: mass above 0 and mu_D at most mu are right.");
    }
    for (double x : h.inertia) {
        if (!number_fits(x, -1e6, 1e6)) return refuse(why, PALPATE_NOT_FINITE, "The inertia is not finite.");
    }
    for (int a = 0; a < 3; ++a) {
        if (!(h.inertia[a] > 0.0)) return refuse(why, PALPATE_NOT_FINITE, "A moment of inertia is not above zero.");
    }
    return true;
}

bool check_element(const palpate_rigid& r, const rigid_element& e, answer& why) noexcept {
    constexpr double far = 1e3;
    if (e.kind >= rigid_kind_count || (e.side != 1 && e.side != -1)) {
        return refuse(why, PALPATE_BAD_LAYOUT, "An element is of no known kind: cook again.");
    }
    if (e.up_count == 0 || e.up_count > 64 || e.up_first > r.head.index_count || e.up_count > r.head.index_count - e.up_first) {
        return refuse(why, PALPATE_BAD_INDEX, "An element's faces lie outside the list: cook again.");
    }
    for (std::uint32_t i = 0; i < e.up_count; ++i) {
        const bool held = &e - r.element < static_cast<std::ptrdiff_t>(r.head.held_count);
        const std::uint32_t up = r.index[e.up_first + i];
        if (up >= r.head.element_count || (up < r.head.held_count) != held) {
            return refuse(why, PALPATE_BAD_INDEX, "An element names a face that is not its object's: cook again.");
        }
    }
    if (e.beside_count > 4096 || e.beside_first > r.head.index_count || e.beside_count > r.head.index_count - e.beside_first) {
        return refuse(why, PALPATE_BAD_INDEX, "A face's neighbours lie outside the list: cook again.");
    }
    const std::uint32_t each = e.kind == rigid_polygon ? 4u : e.kind == rigid_vertex ? 3u : 1u;
    if (e.number_count > 4096 || e.number_count % each != 0 || e.number_first > r.head.number_count ||
        e.number_count > r.head.number_count - e.number_first) {
        return refuse(why, PALPATE_BAD_INDEX, "An element's numbers lie outside the list: cook again.");
    }
    bool fits = vector_fits(e.bound_centre, far) && number_fits(e.bound_radius, 0.0, far) && vector_fits(e.centre, far) &&
                number_fits(e.radius, 0.0, far) && number_fits(e.size, -far, far * far) && number_fits(e.low, -far, far) &&
                number_fits(e.high, -far, far) && number_fits(e.cosine, 0.0, 1.0) && vector_fits(e.normal[0], 2.0) &&
                vector_fits(e.normal[1], 2.0);
    if (e.kind != rigid_vertex) fits = fits && unit(e.axis) && unit(e.across);
    if (e.kind == rigid_segment) fits = fits && unit(e.normal[0]) && unit(e.normal[1]) && e.high > 0.0;
    if (e.kind == rigid_circle) fits = fits && e.radius > 0.0 && number_fits(e.size, -1.0, 1.0) && number_fits(e.low, -1.0, 1.0);
    if (e.kind == rigid_sphere || e.kind == rigid_cylinder || e.kind == rigid_torus) fits = fits && e.radius > 0.0;
    if (e.kind == rigid_disc) fits = fits && e.radius > 0.0 && number_fits(e.size, 0.0, e.radius);
    if (e.kind == rigid_cylinder) fits = fits && e.high > 0.0;
    if (e.kind == rigid_cone) fits = fits && number_fits(e.size, 1e-3, 1e3) && e.cosine > 1e-4 && e.low >= 0.0 && e.high > e.low;
    if (e.kind == rigid_torus) fits = fits && number_fits(e.size, 1e-9, e.radius);
    if (e.kind == rigid_paraboloid) fits = fits && number_fits(e.size, 1e-3, 1e6) && e.high > 0.0;
    return fits || refuse(why, PALPATE_NOT_FINITE, "An element's geometry is not finite or has no size: cook again.");
}

bool check_contents(const palpate_rigid& r, answer& why) noexcept {
    const rigid_header& h = r.head;
    for (std::uint32_t i = 0; i < h.number_count; ++i) {
        if (!number_fits(r.number[i], -1e6, 1e6)) return refuse(why, PALPATE_NOT_FINITE, "A number of a face is not finite.");
    }
    for (std::uint32_t i = 0; i < h.element_count; ++i) {
        if (!check_element(r, r.element[i], why)) return false;
    }
    for (std::uint32_t i = 0; i < h.pair_count; ++i) {
        if (r.pair[i].held >= h.held_count || r.pair[i].fixed < h.held_count || r.pair[i].fixed >= h.element_count) {
            return refuse(why, PALPATE_BAD_INDEX, "A pair names an element that is not there: cook again.");
        }
    }
    for (std::uint32_t i = 0; i < h.merge_count; ++i) {
        if ((i > 0 && r.merge[i].key <= r.merge[i - 1].key) || r.merge[i].region < 1 || r.merge[i].region > 2) {
            return refuse(why, PALPATE_BAD_LAYOUT, "The list of line and plane contacts is not in order: cook again.");
        }
    }
    for (std::uint32_t i = 0; i < h.formation_count; ++i) {
        const rigid_formation& f = r.formation[i];
        if ((i > 0 && f.hash < r.formation[i - 1].hash) || f.count == 0 || f.count > PALPATE_RIGID_CONTACT_LIMIT ||
            f.first > h.formation_index_count || f.count > h.formation_index_count - f.first) {
            return refuse(why, PALPATE_BAD_LAYOUT, "The table of formations is not in order: cook again.");
        }
    }
    return true;
}

}  // namespace
}  // namespace palpate

using namespace palpate;

extern "C" palpate_status palpate_rigid_open(const void* data, size_t size, palpate_rigid** rigid, char* message,
                                             size_t message_size) PALPATE_NOEXCEPT {
    answer why{message, message_size, PALPATE_OK};
    if (rigid != nullptr) *rigid = nullptr;
    if (data == nullptr || rigid == nullptr) {
        refuse(why, PALPATE_BAD_ARGUMENT, "A pointer is null.");
        return why.status;
    }
    rigid_header h;
    if (size < sizeof h) {
        refuse(why, PALPATE_TRUNCATED, "The bytes are fewer than a header of rigid objects.");
        return why.status;
    }
    std::memcpy(&h, data, sizeof h);
    if (h.magic != rigid_magic) {
        refuse(why, PALPATE_NOT_RFIELD, "The first bytes are not those of cooked rigid objects.");
        return why.status;
    }
    if (h.version != rigid_version) {
        refuse(why, PALPATE_WRONG_VERSION, "Cooked by a version with another layout of rigid objects: cook again.");
        return why.status;
    }
    if (h.byte_count != size) {
        refuse(why, PALPATE_TRUNCATED, "Fewer or more bytes than the header of the rigid objects says.");
        return why.status;
    }
    rigid_header blank = h;
    blank.checksum = 0;
    unsigned char first[sizeof blank];
    std::memcpy(first, &blank, sizeof blank);
    const unsigned char* bytes = static_cast<const unsigned char*>(data);
    if (crc32(crc32(0, first, sizeof first), bytes + sizeof first, size - sizeof first) != h.checksum) {
        refuse(why, PALPATE_DAMAGED, "The checksum of the rigid objects does not fit.");
        return why.status;
    }
    if (!check_header(h, size, why)) return why.status;
    constexpr std::size_t alignment = 64;
    const std::size_t front = (sizeof(palpate_rigid) + alignment - 1) / alignment * alignment;
    void* memory = ::operator new(front + size, std::align_val_t{alignment}, std::nothrow);
    if (memory == nullptr) {
        refuse(why, PALPATE_OUT_OF_MEMORY, "There is no memory for the rigid objects.");
        return why.status;
    }
    unsigned char* copy = static_cast<unsigned char*>(memory) + front;
    std::memcpy(copy, data, size);
    palpate_rigid* r = new (memory) palpate_rigid{};
    r->head = h;
    r->element = reinterpret_cast<const rigid_element*>(copy + h.elements);
    r->pair = reinterpret_cast<const rigid_pair*>(copy + h.pairs);
    r->number = reinterpret_cast<const double*>(copy + h.numbers);
    r->index = reinterpret_cast<const std::uint32_t*>(copy + h.indices);
    r->merge = reinterpret_cast<const rigid_merge*>(copy + h.merges);
    r->formation = reinterpret_cast<const rigid_formation*>(copy + h.formations);
    r->formation_index = reinterpret_cast<const std::uint32_t*>(copy + h.formation_indices);
    if (!check_contents(*r, why)) {
        palpate_rigid_close(r);
        return why.status;
    }
    *rigid = r;
    return PALPATE_OK;
}

extern "C" void palpate_rigid_close(palpate_rigid* rigid) PALPATE_NOEXCEPT {
    if (rigid != nullptr) ::operator delete(static_cast<void*>(rigid), std::align_val_t{64});
}

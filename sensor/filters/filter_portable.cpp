#include <algorithm>
#include <limits>

#include "sensor/filters/depth_filter.h"
#include "sensor/filters/filter_kernel.h"

namespace kino::filters {
namespace {

constexpr std::size_t kBlock = 8;

void invert(const float* z, std::size_t n, float* inverse) {
    for (std::size_t i = 0; i < n; ++i) inverse[i] = is_reading(z[i]) ? 1.0f / z[i] : kNone;
}

void smooth_block(const Window& w, const float* inverse, const float* z, std::size_t n,
                  float* out) {
    float sum[kBlock] = {};
    float weight[kBlock];
    std::fill(weight, weight + kBlock, 1.0f);
    for (int t = 0; t < w.taps; ++t) {
        const float* there = inverse + w.offsets[t];
        const float g = w.weights[t];
        for (std::size_t i = 0; i < n; ++i) {
            const float difference = there[i] - inverse[i];
            const float u = difference * w.inverse_threshold;
            const float inside = 1.0f - u * u;
            const float q = (inside > 0.0f ? inside : 0.0f) * g;
            weight[i] = weight[i] + q;
            sum[i] = sum[i] + q * difference;
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        const float moved = z[i] / (1.0f + (sum[i] / weight[i]) * z[i]);
        out[i] = inverse[i] > 0.0f ? moved : 0.0f;
    }
}

void smooth(const Window& w, const float* inverse, const float* z, std::size_t n, float* out) {
    for (std::size_t i = 0; i < n; i += kBlock) {
        smooth_block(w, inverse + i, z + i, std::min(kBlock, n - i), out + i);
    }
}

void support(const Support& s, const float* inverse, const float* z, std::size_t n, float* out) {
    const std::ptrdiff_t pairs[4] = {1, s.pitch, s.pitch + 1, s.pitch - 1};
    for (std::size_t i = 0; i < n; ++i) {
        const float* here = inverse + i;
        const float limit = s.step + s.slope * here[0];
        int agreeing = 0;
        bool between = false;
        for (const std::ptrdiff_t offset : pairs) {
            const float a = here[-offset];
            const float b = here[offset];
            const float to_a = a - here[0];
            const float to_b = b - here[0];
            if (to_a <= limit && to_a >= -limit) ++agreeing;
            if (to_b <= limit && to_b >= -limit) ++agreeing;
            between = between || (to_a > limit && to_b < -limit && b > 0.0f) ||
                      (to_b > limit && to_a < -limit && a > 0.0f);
        }
        out[i] = here[0] > 0.0f && agreeing >= s.minimum && !between ? z[i] : 0.0f;
    }
}

void blend(const Blend& b, const float* z, std::size_t n, const Memory& memory, float* out) {
    for (std::size_t i = 0; i < n; ++i) {
        const float held = memory.z[i];
        const float frames = memory.frames[i];
        if (!is_reading(z[i])) {
            const std::int32_t unseen = memory.unseen[i] + 1;
            const bool keep = held > 0.0f && unseen <= b.persistence;
            memory.unseen[i] = keep ? unseen : 0;
            memory.frames[i] = keep ? frames : 0.0f;
            memory.z[i] = out[i] = keep ? held : 0.0f;
            continue;
        }
        memory.unseen[i] = 0;
        float next = z[i];
        float count = 1.0f;
        if (held > 0.0f) {
            const float difference = (held - z[i]) / (held * z[i]);
            const float u = difference * b.inverse_threshold;
            const float square = u * u;
            const float novelty =
                b.soft ? (square < 1.0f ? square * square : 1.0f) : (square < 1.0f ? 0.0f : 1.0f);
            const float mean = 1.0f / (frames + 1.0f);
            const float gain = b.running ? (mean > b.alpha ? mean : b.alpha) : b.alpha;
            const float step = gain + (1.0f - gain) * novelty;
            if (novelty < 1.0f) {
                const float grown = frames * (1.0f - novelty) + 1.0f;
                count = grown < b.most ? grown : b.most;
                if (step < 1.0f) next = held / (1.0f + (step * difference) * held);
            }
        }
        memory.frames[i] = count;
        memory.z[i] = out[i] = next;
    }
}

void classify(const float* z, std::size_t n, float* out, std::uint64_t* bits) {
    for (std::size_t first = 0; first < n; first += 64) {
        std::uint64_t word = 0;
        for (std::size_t i = first; i < std::min(n, first + 64); ++i) {
            const bool reading = is_reading(z[i]);
            out[i] = reading ? z[i] : 0.0f;
            word |= std::uint64_t{reading} << (i - first);
        }
        bits[first / 64] = word;
    }
}

void order(float& a, float& b) {
    const float low = a < b ? a : b;
    b = a > b ? a : b;
    a = low;
}

void halve(const Halve& h, const float* upper, const float* lower, std::size_t n, float* out) {
    constexpr float kEmpty = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < n; ++i) {
        float z[4] = {upper[2 * i], upper[2 * i + 1], lower[2 * i], lower[2 * i + 1]};
        int count = 0;
        for (float& value : z) {
            const bool reading = is_reading(value);
            count += reading ? 1 : 0;
            value = reading ? value : kEmpty;
        }
        order(z[0], z[1]);
        order(z[2], z[3]);
        order(z[0], z[2]);
        order(z[1], z[3]);
        order(z[1], z[2]);
        const float median = count > 2 ? z[1] : z[0];
        float sum = 0.0f;
        float used = 0.0f;
        for (const float value : z) {
            // Not a number, and so not near, for an empty place.
            const float difference = (median - value) / (median * value);
            const bool near = difference <= h.threshold && difference >= -h.threshold;
            sum = sum + (near ? difference : 0.0f);
            used = used + (near ? 1.0f : 0.0f);
        }
        const float mean = median / (1.0f + (sum / used) * median);
        out[i] = count > 0 && count >= h.readings ? mean : 0.0f;
    }
}

}  // namespace

const Functions kPortable = {invert, smooth, support, blend, classify, halve, "portable"};

const Functions& choose(bool simd) {
#if defined(__x86_64__)
    static const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (simd && avx2) return kAvx2;
#endif
    (void)simd;
    return kPortable;
}

}  // namespace kino::filters

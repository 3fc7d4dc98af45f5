#include "apps/demo/balls.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace kino::demo {
namespace {

constexpr double kLongestS = 0.1;
/// What comes in slower than this stays.
constexpr double kBounceM_s = 0.22;
constexpr double kRestM_s = 0.02;
constexpr double kFlashM_s = 0.7, kFlashS = 0.3;
constexpr int kRounds = 3;  // through the solids, for corners

bool all_finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

bool Balls::throw_ball(const glm::dvec3& at_m, const glm::dvec3& speed_m_s, int painter,
                       double rounds) {
    if (!all_finite(at_m) || !all_finite(speed_m_s) || glm::length(at_m) > 1e3) return false;
    Ball ball{.at_m = at_m, .speed_m_s = speed_m_s, .painter = painter, .rounds = rounds};
    const double speed = glm::length(speed_m_s);
    if (speed > rules_.fastest_m_s) ball.speed_m_s *= rules_.fastest_m_s / speed;
    if (!all_finite(ball.speed_m_s)) return false;
    // A hand may be in a wall; a ball begins where there is room.
    for (int i = 0; i < 2 * kRounds; ++i) {
        for (const Solid& solid : solids_) {
            if (const auto contact = touch(solid, ball.at_m, rules_.radius_m)) {
                ball.at_m += contact->depth_m * contact->normal;
            }
        }
    }
    ball.shown_m = ball.at_m;
    ball.number = thrown_++;
    if (balls_.size() >= rules_.most) balls_.erase(balls_.begin());
    balls_.push_back(ball);
    return true;
}

void Balls::clear() {
    balls_.clear();
    left_s_ = 0;
}

void Balls::shown() {
    for (Ball& ball : balls_) ball.shown_m = ball.at_m;
}

void Balls::move(Ball& ball) {
    const glm::dvec3 g(0, -rules_.gravity_m_s2, 0);
    ball.at_m += kStepS * ball.speed_m_s + 0.5 * kStepS * kStepS * g;
    ball.speed_m_s += kStepS * g;
    ball.age_s += kStepS;
    ball.flash = std::max(0.0, ball.flash - kStepS / kFlashS);
}

void Balls::meet() {
    const double width = 2 * rules_.radius_m;
    for (std::size_t i = 0; i < balls_.size(); ++i) {
        for (std::size_t j = i + 1; j < balls_.size(); ++j) {
            Ball &a = balls_[i], &b = balls_[j];
            const glm::dvec3 between = b.at_m - a.at_m;
            const double distance = glm::length(between);
            if (!(distance < width) || distance < 1e-9) continue;
            const glm::dvec3 normal = between / distance;
            // Of equal weight: what one gains in height, the other loses.
            const glm::dvec3 apart = 0.5 * (width - distance) * normal;
            a.at_m -= apart;
            b.at_m += apart;
            const double closing = glm::dot(a.speed_m_s - b.speed_m_s, normal);
            if (closing <= 0) continue;
            const glm::dvec3 kick = 0.5 * (1 + rules_.restitution) * closing * normal;
            a.speed_m_s -= kick;
            b.speed_m_s += kick;
            if (closing > kFlashM_s) a.flash = b.flash = 1;
        }
    }
}

void Balls::bounce(Ball& ball) {
    const glm::dvec3 g(0, -rules_.gravity_m_s2, 0);
    for (int round = 0; round < kRounds; ++round) {
        bool touched = false;
        for (const Solid& solid : solids_) {
            const auto contact = touch(solid, ball.at_m, rules_.radius_m);
            if (!contact) continue;
            touched = true;
            const glm::dvec3& n = contact->normal;
            const glm::dvec3 back = contact->depth_m * n;
            ball.at_m += back;
            const double along_normal = glm::dot(ball.speed_m_s, n);
            glm::dvec3 aside = ball.speed_m_s - along_normal * n;
            // The speed that it had, or has, at the surface; height that is gained is paid for.
            const double gain = 2 * glm::dot(g, back);
            double square = along_normal * along_normal + gain;
            if (square < 0) {
                const double aside_square = glm::dot(aside, aside);
                aside *=
                    aside_square > 0 ? std::sqrt(std::max(0.0, 1 + square / aside_square)) : 0.0;
                square = 0;
            }
            const double at_surface = std::sqrt(square);
            if (along_normal >= 0) {
                ball.speed_m_s = aside + std::min(along_normal, at_surface) * n;
                continue;
            }
            const bool bounces = at_surface > kBounceM_s;
            if (bounces) {
                aside *= 1 - rules_.grip;
            } else {
                aside *= std::exp(-rules_.rolling_per_s * kStepS);
                if (glm::length(aside) < kRestM_s && n.y > 0.7) aside = glm::dvec3(0);
            }
            if (at_surface > kFlashM_s) ball.flash = 1;
            ball.speed_m_s = aside + (bounces ? rules_.restitution * at_surface : 0) * n;
        }
        if (!touched) return;
    }
}

void Balls::step(double dt_s) {
    left_s_ += dt_s > 0 ? std::min(dt_s, kLongestS) : 0;
    while (left_s_ >= kStepS) {
        left_s_ -= kStepS;
        for (Ball& ball : balls_) move(ball);
        meet();
        for (Ball& ball : balls_) bounce(ball);
    }
    std::erase_if(balls_, [&](const Ball& ball) {
        return !(ball.age_s < rules_.life_s) || !all_finite(ball.at_m) ||
               !all_finite(ball.speed_m_s) || glm::length(ball.at_m) > 1e3;
    });
}

double Balls::weight(const Ball& ball) const {
    const double left = std::clamp((rules_.life_s - ball.age_s) / rules_.fade_s, 0.0, 1.0);
    return left * left * (3 - 2 * left);
}

double Balls::energy() const {
    double sum = 0;
    for (const Ball& ball : balls_) {
        sum += 0.5 * glm::dot(ball.speed_m_s, ball.speed_m_s) + rules_.gravity_m_s2 * ball.at_m.y;
    }
    return sum;
}

}  // namespace kino::demo

#include "tests/viz/accel/support/embree_peer.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <cstring>

#include "base/check.h"

namespace kino::test {

struct EmbreePeer::State {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
};

namespace {
RTCRay to_embree(const Ray& ray) {
    RTCRay to{};
    to.org_x = ray.origin.x;
    to.org_y = ray.origin.y;
    to.org_z = ray.origin.z;
    to.tnear = ray.t_min;
    to.dir_x = ray.direction.x;
    to.dir_y = ray.direction.y;
    to.dir_z = ray.direction.z;
    to.tfar = ray.t_max;
    to.mask = ~0u;
    return to;
}
}  // namespace

EmbreePeer::EmbreePeer(std::span<const Triangle> triangles, int threads)
    : state_(std::make_unique<State>()) {
    state_->device = rtcNewDevice(fmt::format("threads={}", threads).c_str());
    KINO_CHECK(state_->device != nullptr);
    state_->scene = rtcNewScene(state_->device);
    rtcSetSceneFlags(state_->scene, RTC_SCENE_FLAG_ROBUST);
    if (!triangles.empty()) {
        RTCGeometry geometry = rtcNewGeometry(state_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        void* places =
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    sizeof(glm::vec3), 3 * triangles.size());
        std::memcpy(places, triangles.data(), triangles.size_bytes());
        auto* corners = static_cast<std::uint32_t*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                    3 * sizeof(std::uint32_t), triangles.size()));
        for (std::uint32_t i = 0; i < 3 * triangles.size(); ++i) corners[i] = i;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(state_->scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(state_->scene);
}

EmbreePeer::~EmbreePeer() {
    rtcReleaseScene(state_->scene);
    rtcReleaseDevice(state_->device);
}

RayHit EmbreePeer::closest_hit(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray = to_embree(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(state_->scene, &context, &query);
    RayHit hit;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
    hit.t = query.ray.tfar;
    hit.triangle = query.hit.primID;
    hit.v = query.hit.u;
    hit.w = query.hit.v;
    return hit;
}

bool EmbreePeer::any_hit(const Ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRay query = to_embree(ray);
    rtcOccluded1(state_->scene, &context, &query);
    return query.tfar < 0;
}

}  // namespace kino::test

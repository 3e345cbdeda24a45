// The colours of pixels, as docs and README read the format, in intervals: what they enclose is true whatever is
// rounded. A decision that is not certain ends the pixel.

#pragma once

#include <vector>

#include "bodies.h"
#include "prepared.h"
#include "search.h"
#include "shading.h"
#include "tree.h"

namespace certified {

template <typename End>
class Tracer {
 public:
    using I = Interval<End>;
    using V = Vector<I>;
    using R = Ray<End>;

    // `plain`: for tests before those with intervals. `quick`: one in doubles, to which a tracer with more digits
    // leaves what doubles decide. Or none.
    Tracer(const PreparedScene<End>& scene, const Tree& tree, bool last, const PlainScene* plain, Tracer<double>* quick)
        : scene_(scene),
          judge_(last, scene.scene.ties),
          quick_(quick),
          search_(scene, tree, judge_, plain, quick == nullptr ? nullptr : &quick->search_),
          shading_(scene, search_, judge_) {}

    // Parts refer to each other.
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    // The mean of a pixel's rays. Throws Undecided.
    V pixel(int column, int row) {
        judge_.tied = judge_.degenerate = false;
        shading_.doubt = Reason::none;
        const Scene& s = scene_.scene;
        V sum{0, 0, 0};
        for (int j = 0; j < s.grid; ++j) {
            for (int i = 0; i < s.grid; ++i) {
                sum = sum + color(primary(column, row, i, j));
            }
        }
        if (s.grid == 1) {
            return sum;
        }
        const I count = s.grid * s.grid;
        return {sum.x / count, sum.y / count, sum.z / count};
    }

    // What was not certain, but could be told with all its answers.
    Reason doubt() const { return shading_.doubt; }
    bool tied() const { return judge_.tied; }
    bool degenerate() const { return judge_.degenerate; }

 private:
    struct Task {
        R ray;
        I weight;
        int depth;
    };

    // Through the window, from -W/H to W/H and from -1 to 1, at the grid's cell (i, j) of a pixel.
    R primary(int column, int row, int i, int j) const {
        const Scene& s = scene_.scene;
        // In units of half a cell.
        const int cells = 2 * s.grid, shift = s.corner ? s.grid : 0;
        const I x = I(2 * (column * cells + 2 * i + 1 - shift) - s.width * cells) / I(s.height * cells);
        const I y = I(s.height * cells - 2 * (row * cells + 2 * j + 1 - shift)) / I(s.height * cells);
        R ray;
        ray.origin = scene_.eye;
        ray.direction = normalized(scene_.view + x * scene_.right + y * scene_.up);
        ray.from_eye = true;
        return ray;
    }

    V color(const R& primary) {
        V sum{0, 0, 0};
        tasks_.clear();
        tasks_.push_back({primary, I(1), 0});
        while (!tasks_.empty()) {
            const Task task = tasks_.back();
            tasks_.pop_back();
            sum = sum + task.weight * shade(task);
        }
        return sum;
    }

    // A ray's own colour; what follows it becomes tasks.
    V shade(const Task& task) {
        const R& ray = task.ray;
        Met<End> met;
        if (!search_.nearest(ray, met)) {
            return scene_.background;
        }
        const V point = ray.origin + met.t * ray.direction;
        const V outward = search_.bodies().surfaces().normal(met.surface, point);
        const V normal = met.behind ? -outward : outward;
        follow(task, met, point, normal);
        return surface_color(ray, met, point, normal);
    }

    // Digits beyond those of doubles matter to a colour only where it jumps.
    V surface_color(const R& ray, const Met<End>& met, const V& point, const V& normal) {
        if constexpr (!std::is_same_v<End, double>) {
            if (quick_ != nullptr) {
                Shading<double>& shading = quick_->shading_;
                shading.doubt = Reason::none;
                try {
                    const Vector<Interval<double>> color = shading.color(
                        in_doubles(ray), {in_doubles(met.t), met.body, met.surface, met.inside, met.behind},
                        in_doubles(point), in_doubles(normal));
                    if (shading.doubt == Reason::none) {
                        return {widened<End>(color.x), widened<End>(color.y), widened<End>(color.z)};
                    }
                } catch (const Undecided&) {  // more digits may tell
                }
            }
        }
        return shading_.color(ray, met, point, normal);
    }

    void follow(const Task& task, const Met<End>& met, const V& point, const V& normal) {
        const Body& body = scene_.scene.bodies[static_cast<std::size_t>(met.body)];
        const auto& finish = scene_.finishes[static_cast<std::size_t>(body.finish)];
        const bool reflects = finish.reflects && worthwhile(task, task.weight * finish.kr);
        const bool transmits = finish.transmits && worthwhile(task, task.weight * finish.kt);
        if (!reflects && !transmits) {
            return;
        }
        R next;
        next.origin = point;
        next.body = met.body;
        next.surface = met.surface;
        const V& direction = task.ray.direction;
        const I across = dot(direction, normal);
        const V mirrored = direction - I(2) * across * normal;
        if (reflects) {
            next.direction = mirrored;
            next.inside = met.inside;
            tasks_.push_back({next, task.weight * finish.kr, task.depth + 1});
        }
        if (transmits) {
            const I eta = met.inside ? I(1) / finish.eta : finish.eta;
            const I cosine2 = (I(1) - eta) * (I(1) + eta) + square(eta * across);
            const int sign = judge_.sign(cosine2, Reason::reflection);
            next.inside = sign < 0 ? met.inside : !met.inside;
            // The root of what is 0 by rule, whose half of the digits would be lost.
            const I cosine = sign == 0 ? I(0) : sqrt(cosine2);
            next.direction = sign < 0 ? mirrored : eta * direction - (eta * across + cosine) * normal;
            tasks_.push_back({next, task.weight * finish.kt, task.depth + 1});
        }
    }

    bool worthwhile(const Task& task, const I& weight) {
        return task.depth < scene_.scene.max_depth &&
               (scene_.cutoff.is_zero() || judge_.sign(weight - scene_.cutoff, Reason::cutoff) >= 0);
    }

    template <typename>
    friend class Tracer;

    const PreparedScene<End>& scene_;
    Judge<End> judge_;
    Tracer<double>* quick_;
    Search<End> search_;
    Shading<End> shading_;
    std::vector<Task> tasks_;
};

}  // namespace certified

// Reads scene files that hold nothing unusual, straight into the objects of a model in Python.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "binding/bindings.h"
#include "scene_file/words.h"

namespace nb = nanobind;
using namespace nb::literals;
using whitted::scene_file::Unusual;
using whitted::scene_file::Words;

namespace {

void expect(bool usual) {
    if (!usual) {
        throw Unusual{};
    }
}

// ---- Objects of Python ------------------------------------------------------------------------------------------------

nb::object checked(PyObject* made) {
    if (made == nullptr) {
        throw nb::python_error();
    }
    return nb::steal(made);
}

// Numbers of Python; of those that a scene repeats many share an object.
class Numbers {
 public:
    nb::object operator()(double value) {
        std::size_t bits = 0;
        static_assert(sizeof bits == sizeof value);
        std::memcpy(&bits, &value, sizeof value);
        Shared& shared = shared_[(bits * 0x9e3779b97f4a7c15U) >> 54U];
        if (!shared.number.is_valid() || shared.bits != bits) {  // -0 is not 0
            shared = {bits, checked(PyFloat_FromDouble(value))};
        }
        return shared.number;
    }

 private:
    struct Shared {
        std::size_t bits = 0;
        nb::object number;
    };
    std::array<Shared, 1024> shared_;
};

// What makes objects of a frozen dataclass as its `__init__` does, field by field, but without its way through Python.
template <std::size_t Size>
class Maker {
 public:
    Maker(const nb::object& model, const char* name, const std::array<const char*, Size>& fields)
        : type_(model.attr(name)) {
        for (std::size_t i = 0; i < Size; ++i) {
            fields_[i] = checked(PyUnicode_InternFromString(fields[i]));
        }
    }

    nb::object operator()(const std::array<nb::handle, Size>& values) const {
        auto* type = reinterpret_cast<PyTypeObject*>(type_.ptr());
        nb::object made = checked(type->tp_alloc(type, 0));
        for (std::size_t i = 0; i < Size; ++i) {
            if (PyObject_GenericSetAttr(made.ptr(), fields_[i].ptr(), values[i].ptr()) != 0) {
                throw nb::python_error();
            }
        }
        return made;
    }

 private:
    nb::object type_;
    std::array<nb::object, Size> fields_;
};

// ---- The sections of a file -------------------------------------------------------------------------------------------

class Scanner {
 public:
    Scanner(std::string_view text, const nb::object& model)
        : words_(text),
          model_(model),
          sphere_(model, "Sphere", {"center", "radius"}),
          polyhedron_(model, "Polyhedron", {"planes"}),
          object_(model, "Object", {"pigment", "finish", "shape", "line", "move"}),
          still_(nb::make_tuple(0.0, 0.0, 0.0)) {}

    nb::tuple scene() {
        nb::object view = camera();
        nb::list lights, light_lines, pigments, pigment_lines, finishes, finish_lines, objects;
        const std::size_t light_count = words_.whole();
        expect(light_count > 0);
        for (std::size_t k = 0; k < light_count; ++k) {
            lights.append(light(k == 0));
            light_lines.append(line_);
        }
        for (std::size_t count = words_.whole(); count > 0; --count) {
            pigments.append(pigment());
            pigment_lines.append(line_);
        }
        for (std::size_t count = words_.whole(); count > 0; --count) {
            finishes.append(finish());
            finish_lines.append(line_);
        }
        for (std::size_t i = 0; i < std::max(pigments.size(), finishes.size()); ++i) {
            indices_.append(i);
        }
        for (std::size_t count = words_.whole(); count > 0; --count) {
            objects.append(object(pigments.size(), finishes.size()));
        }
        expect(words_.next().empty());
        return nb::make_tuple(view, nb::tuple(lights), nb::tuple(pigments), nb::tuple(finishes), nb::tuple(objects),
                              nb::tuple(light_lines), nb::tuple(pigment_lines), nb::tuple(finish_lines));
    }

 private:
    using Vector = std::array<double, 3>;

    template <std::size_t Size>
    std::array<double, Size> numbers() {
        std::array<double, Size> found;
        for (double& value : found) {
            value = words_.number();
        }
        return found;
    }

    template <std::size_t Size>
    nb::object tuple_of(const std::array<double, Size>& values) {
        nb::object made = checked(PyTuple_New(Size));
        for (std::size_t i = 0; i < Size; ++i) {
            PyTuple_SET_ITEM(made.ptr(), static_cast<Py_ssize_t>(i), shared_(values[i]).release().ptr());
        }
        return made;
    }

    nb::object camera() {
        const Vector eye = numbers<3>(), look_at = numbers<3>(), up = numbers<3>();
        const double fovy = words_.number();
        expect(fovy > 0 && fovy < 180);
        const Vector view =
            direction({look_at[0] / 2 - eye[0] / 2, look_at[1] / 2 - eye[1] / 2, look_at[2] / 2 - eye[2] / 2});
        const auto [a, b, c] = view;
        const auto [x, y, z] = direction(up);
        // The sine of the angle between them. It need only be above 1e-9, but what is as small is looked at closer.
        expect(std::hypot(b * z - c * y, c * x - a * z, a * y - b * x) > 1e-6);
        return model_.attr("Camera")(tuple_of(eye), tuple_of(look_at), tuple_of(up), fovy);
    }

    // A vector scaled to length 1; NaN if it is zero.
    static Vector direction(const Vector& v) {
        const double largest = std::max({std::abs(v[0]), std::abs(v[1]), std::abs(v[2])});
        const Vector scaled{v[0] / largest, v[1] / largest, v[2] / largest};
        const double length = std::hypot(scaled[0], scaled[1], scaled[2]);
        return {scaled[0] / length, scaled[1] / length, scaled[2] / length};
    }

    nb::object light(bool ambient) {
        const Vector position = first_number_and<3>(), color = numbers<3>(), attenuation = numbers<3>();
        expect(ambient || std::max(attenuation[0], attenuation[2]) > 0);  // so it is positive somewhere
        return model_.attr("Light")(tuple_of(position), tuple_of(color), tuple_of(attenuation));
    }

    nb::object pigment() {
        const std::string_view kind = first_word();
        if (kind == "solid") {
            return model_.attr("Solid")(tuple_of(numbers<3>()));
        }
        if (kind == "checker") {
            const Vector first = numbers<3>(), second = numbers<3>();
            const double size = words_.number();
            expect(size > 0);
            return model_.attr("Checker")(tuple_of(first), tuple_of(second), size);
        }
        expect(kind == "texmap" || kind == "textmap");
        const std::string_view name = words_.next();
        const long line = words_.line();
        const auto p0 = numbers<4>(), p1 = numbers<4>();
        return nb::make_tuple(nb::str(name.data(), name.size()), tuple_of(p0), tuple_of(p1), line);
    }

    nb::object finish() {
        const std::array<double, 7> values = first_number_and<7>();
        const auto [ka, kd, ks, alpha, kr, kt, ior] = values;
        expect(std::min({ka, kd, ks, alpha, kr, kt}) >= 0 && (kt == 0 || ior > 0));
        return model_.attr("Finish")(ka, kd, ks, alpha, kr, kt, ior);
    }

    nb::object object(std::size_t pigments, std::size_t finishes) {
        const nb::object pigment = index(pigments);
        const long line = words_.line();
        const nb::object finish = index(finishes);
        const nb::object body = shape();
        nb::object move = still_;
        if (words_.peek() == "move") {
            words_.next();
            move = tuple_of(numbers<3>());
        }
        return object_({pigment, finish, body, nb::int_(line), move});
    }

    nb::object index(std::size_t count) {
        const std::size_t value = words_.whole();
        expect(value < count);
        return indices_[value];
    }

    nb::object shape() {
        const std::string_view kind = words_.next();
        if (kind == "sphere") {
            const Vector center = numbers<3>();
            const double radius = words_.number();
            expect(radius > 0);
            return sphere_({tuple_of(center), shared_(radius)});
        }
        expect(kind == "polyhedron");
        const std::size_t count = words_.whole();
        expect(count > 0);
        nb::list planes;
        for (std::size_t k = 0; k < count; ++k) {
            const std::array<double, 4> plane = numbers<4>();
            expect(plane[0] != 0 || plane[1] != 0 || plane[2] != 0);
            planes.append(tuple_of(plane));
        }
        return polyhedron_({nb::tuple(planes)});
    }

    // The first word of an entry, whose line is noted.
    std::string_view first_word() {
        words_.peek();
        line_ = words_.line();
        return words_.next();
    }

    template <std::size_t Size>
    std::array<double, Size> first_number_and() {
        words_.peek();
        line_ = words_.line();
        return numbers<Size>();
    }

    Words words_;
    nb::object model_;
    Maker<2> sphere_;
    Maker<1> polyhedron_;
    Maker<5> object_;
    nb::object still_;
    nb::list indices_;
    Numbers shared_;
    long line_ = 0;  // of the entry at hand
};

nb::object scan_scene(const nb::bytes& text, const nb::object& model) {
    try {
        return Scanner({text.c_str(), text.size()}, model).scene();
    } catch (const Unusual&) {
        return nb::none();
    }
}

}  // namespace

void bind_scene_file(nb::module_& module) {
    module.def(
        "scan_scene", &scan_scene, "text"_a, "model"_a,
        "Read a scene file, if it holds nothing unusual; None where a closer look is needed, be it wrong or not.\n"
        "`model` has the classes of what is read, the module `converter.scene.model`.\n\n"
        "Gives the camera, lights, pigments, finishes, objects, and the lines of lights, pigments and finishes.\n"
        "For a texmap there is (name, p0, p1, line of the name).");
}

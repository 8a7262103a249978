// The extension module rtamt.engine._core: what Python may call, and nothing else.
#include "../program/opcodes.hpp"
#include "batch.hpp"
#include "dense_direct_evaluator.hpp"
#include "dense_early_monitor.hpp"
#include "direct_evaluator.hpp"
#include "early_monitor.hpp"
#include "evaluator.hpp"
#include "failures.hpp"
#include "fleet.hpp"
#include "monitor_module.hpp"
#include "offline.hpp"
#include "online.hpp"
#include "recording.hpp"
#include "reorder_buffer.hpp"
#include "update_signal.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <string_view>
#include <vector>

namespace nb = nanobind;

namespace {

std::vector<std::string_view> opcode_names() {
    std::vector<std::string_view> names;
    names.reserve(rtamt::opcodes.size());
    for (const rtamt::OpcodeInfo& opcode : rtamt::opcodes)
        names.push_back(opcode.name);
    return names;
}

nb::object new_exception(const nb::module_& module, const char* name, const char* doc) {
    const auto qualified = nb::cast<std::string>(module.attr("__name__")) + "." + name;
    auto type = nb::steal<nb::object>(
        PyErr_NewExceptionWithDoc(qualified.c_str(), doc, PyExc_Exception, nullptr));
    if (!type.is_valid()) throw nb::python_error();
    nb::setattr(module, name, type);
    return type;
}

} // namespace

NB_MODULE(_core, m) {
    m.doc() =
        "The compiled back end: runs serialised programs over samples, in discrete or dense time.";

    nb::register_exception_translator(rtamt::python::translate_memory);
#ifdef NDEBUG
    // When a process ends, a daemon thread may still hold a monitor, which is no leak.
    nb::set_leak_warnings(false);
#endif

    const rtamt::python::Exceptions exceptions{
        new_exception(m, "Refused", "An update was refused; the monitor is as it was."),
        nb::module_::import_("rtamt.usage_guard").attr("in_use"),
        new_exception(m, "Undefined",
                      "An operation made NaN; args are the instruction and the sample, or "
                      "the tick in dense time; online in discrete time `time` is that of the "
                      "sample. Or a call failed: then also what it said, and "
                      "the cause is what a Python operator raised.")};

    rtamt::python::add_monitors(m, exceptions);
    rtamt::python::add_early_monitor(m, exceptions);
    rtamt::python::add_dense_early_monitor(m, exceptions);
    rtamt::python::add_online(m);
    rtamt::python::add_offline(m, exceptions);
    rtamt::python::add_evaluator(m, exceptions);
    rtamt::python::add_direct_evaluator(m);
    rtamt::python::add_dense_direct_evaluator(m);
    rtamt::python::add_batch(m);
    rtamt::python::add_fleet(m);
    rtamt::python::add_reorder_buffer(m);
    rtamt::python::add_recording(m);
    rtamt::python::add_update_signal(m);

    m.def("opcode_names", &opcode_names, "The names of the opcodes, in the order of their codes.");
}

#include "program/fault.hpp"

#include "check.hpp"

#include <string>

using rtamt::Fault;

TEST_CASE("keeps a copy of a sentence and cuts a long one") {
    std::string sentence = "it broke";
    const Fault fault(sentence.c_str());
    sentence = "changed";
    CHECK((fault && fault.text() == "it broke"));
    const std::string novel(1000, 'x');
    CHECK(Fault(novel.c_str()).text() == novel.substr(0, 256));
}

TEST_CASE("no sentence is no fault") {
    CHECK((!Fault() && !Fault(nullptr) && Fault().text().empty()));
}

// The same in C++: what is planned frees itself, and errors are exceptions. plan_cpp PROGRAM.json

#include <iiwasim.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <stdexcept>

namespace {

struct Free {
    void operator()(IiwasimProgram *program) const { iiwasim_program_free(program); }
    void operator()(IiwasimPlan *plan) const { iiwasim_plan_free(plan); }
};
using Program = std::unique_ptr<IiwasimProgram, Free>;
using Plan = std::unique_ptr<IiwasimPlan, Free>;

void check(IiwasimStatus status) {
    if (status == IIWASIM_STATUS_OK) {
        return;
    }
    IiwasimError error{};
    iiwasim_last_error(&error);
    throw std::runtime_error(error.message);
}

Program load(const char *path) {
    IiwasimProgram *program = nullptr;
    check(iiwasim_program_load(path, &program));
    return Program(program);
}

Plan plan(const Program &program) {
    IiwasimPlan *plan = nullptr;
    check(iiwasim_plan(program.get(), nullptr, &plan));
    return Plan(plan);
}

}  // namespace

int main(int argc, char **argv) {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s PROGRAM.json\n", argv[0]);
        return EXIT_FAILURE;
    }
    try {
        const Plan planned = plan(load(argv[1]));
        double cycle_time_s = 0.0;
        check(iiwasim_plan_cycle_time_s(planned.get(), &cycle_time_s));
        IiwasimState end{};
        check(iiwasim_plan_at(planned.get(), cycle_time_s, &end));
        std::printf("%.3f s, then A4 is at %.5f rad\n", cycle_time_s, end.q[3]);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s\n", error.what());
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

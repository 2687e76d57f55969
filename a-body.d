body.o: common/scene/body.cpp /tmp/c_shell/common/scene/scene.hpp \
 /tmp/c_shell/common/core/schema.hpp \
 /tmp/c_shell/common/core/fidelity.hpp

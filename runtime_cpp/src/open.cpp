extern "C" int palpate_abi_version() { return 1; }

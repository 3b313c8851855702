// Entry point of the check targets, which only prove that a stage links with the stages before it.
int main() { return 0; }

flat in uint body;

layout(location = 0) out uint out_id;

void main() { out_id = body; }

/* A compiled node on rcl: publishes the parameter robot_description as robot_state_publisher does. */
#include <rcl/error_handling.h>
#include <rcl/rcl.h>
#include <rcl_yaml_param_parser/parser.h>
#include <rosidl_runtime_c/string_functions.h>
#include <signal.h>
#include <std_msgs/msg/string.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static volatile sig_atomic_t ended = 0;
static void end(int number) { (void)number; ended = 1; }

static const char *description(const rcl_params_t *parameters)
{
  for (size_t node = 0; parameters && node < parameters->num_nodes; ++node)
    for (size_t one = 0; one < parameters->params[node].num_params; ++one)
      if (!strcmp(parameters->params[node].parameter_names[one], "robot_description"))
        return parameters->params[node].parameter_values[one].string_value;
  return NULL;
}

int main(int argc, char **argv)
{
  signal(SIGINT, end);
  signal(SIGTERM, end);
  rcl_allocator_t allocator = rcl_get_default_allocator();
  rcl_init_options_t options = rcl_get_zero_initialized_init_options();
  rcl_context_t context = rcl_get_zero_initialized_context();
  rcl_node_t node = rcl_get_zero_initialized_node();
  rcl_publisher_t publisher = rcl_get_zero_initialized_publisher();
  rcl_node_options_t node_options = rcl_node_get_default_options();
  rcl_publisher_options_t publisher_options = rcl_publisher_get_default_options();
  publisher_options.qos.depth = 1;
  publisher_options.qos.durability = RMW_QOS_POLICY_DURABILITY_TRANSIENT_LOCAL;
  rcl_params_t *parameters = NULL;
  if (rcl_init_options_init(&options, allocator) ||
      rcl_init(argc, (const char *const *)argv, &options, &context) ||
      rcl_node_init(&node, "robot_state_publisher", "", &context, &node_options) ||
      rcl_arguments_get_param_overrides(&context.global_arguments, &parameters) ||
      rcl_publisher_init(&publisher, &node,
                         ROSIDL_GET_MSG_TYPE_SUPPORT(std_msgs, msg, String), "robot_description",
                         &publisher_options)) {
    fprintf(stderr, "%s\n", rcl_get_error_string().str);
    return 1;
  }
  std_msgs__msg__String message;
  std_msgs__msg__String__init(&message);
  const char *text = description(parameters);
  rosidl_runtime_c__String__assign(&message.data, text ? text : "");
  if (rcl_publish(&publisher, &message, NULL)) return 1;
  fprintf(stderr, "compiled publisher of %zu characters\n", message.data.size);
  while (!ended) pause();
  fprintf(stderr, "compiled publisher ends\n");
  (void)rcl_publisher_fini(&publisher, &node);
  (void)rcl_node_fini(&node);
  (void)rcl_shutdown(&context);
  return 0;
}

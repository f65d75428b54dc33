%
O{{ number }} ({{ title }})
{% for comment in header -%}
({{ comment }})
{% endfor -%}
{% for block in blocks -%}
{{ block }}
{% endfor -%}
%
